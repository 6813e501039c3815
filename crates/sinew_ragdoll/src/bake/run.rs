//! Steps the world of a bake with its characters and keyframed bodies.

use super::actor::Actor;
use super::{BakeInput, BakeMover, Baked};
use sinew_math::Writer;
use sinew_math::hash::hash_bytes;
use sinew_physics::{BodyId, World};

/// A bake in progress.
pub(super) struct Run<'a> {
    world: World,
    actors: Vec<Actor<'a>>,
    movers: Vec<(BodyId, &'a BakeMover<'a>)>,
}

impl<'a> Run<'a> {
    pub fn new(inputs: &'a [BakeInput<'a>]) -> Self {
        let mut world = World::new(inputs[0].world.clone());
        let mut movers = Vec::new();
        for input in inputs {
            for body in input.bodies {
                world.add_body(body);
            }
            for field in input.fields {
                world.add_field(field);
            }
            movers.extend(input.movers.iter().map(|mover| (mover.enter(&mut world), mover)));
        }
        let is_alone = inputs.len() == 1;
        let actors = inputs.iter().map(|input| Actor::new(input, is_alone, &mut world)).collect();
        let mut run = Self { world, actors, movers };
        let Self { world, actors, .. } = &mut run;
        for actor in actors {
            actor.begin(world);
        }
        run
    }

    pub fn time(&self) -> f32 {
        self.world.time() as f32
    }

    /// Steps the world once, and applies the pushes that are due at the step's end.
    pub fn step(&mut self) {
        let Self { world, actors, movers } = self;
        for (id, mover) in movers {
            mover.lead(*id, world);
        }
        actors.iter_mut().for_each(|actor| actor.meter.before_step(world));
        world.step();
        actors.iter_mut().for_each(|actor| actor.measure(world));
        actors.iter_mut().for_each(|actor| actor.update(world));
    }

    /// Returns the clips and metrics of all characters.
    pub fn finish(self, inputs: &[BakeInput<'_>]) -> Vec<Baked> {
        let Self { world, actors, .. } = self;
        let of_world = {
            let mut w = Writer::new();
            world.save(&mut w);
            w
        };
        let finish = |(actor, input): (Actor<'_>, &BakeInput<'_>)| {
            let mut w = of_world.clone();
            actor.character.save(&mut w);
            actor.finish(input, world.step_count(), hash_bytes(w.as_bytes()))
        };
        actors.into_iter().zip(inputs).map(finish).collect()
    }
}
