//! Feet of a walking character: a foot on the ground stays planted where it landed, and a foot in the air is raised
//! over edges.
//!
//! A planted foot keeps its position on the ground: the clip's displacement is removed, except for the roll from heel
//! to ball. In the air the offset decays, and the foot follows the height of the ground at its landing point, which is
//! predicted over [`LOOKS_AHEAD`]. Feet follow continuous ground immediately, and edges like a critically damped
//! spring.

use super::CharacterDef;
use super::feet::{Feet, Stand};
use super::gait::root_step;
use super::ground;
use super::legs::{Legs, Need};
use crate::character::tuning::{
    FOOT_EDGE, FOOT_FLOOR, FOOT_HOME, FOOT_RANGE, FOOT_SEARCH, LANDS, LEAST_TREAD, LOOKS_AHEAD, MOST_ASTRAY,
    PELVIS_RISES, RELEASES, RISES, SMALL_WAY, SOLE_SINKS, STANCE_HEIGHT, STANCE_SPEED, STEEPEST_TREAD,
    TOES_CLEAR, TOES_OVER, TREAD_QUICKNESS, TREAD_RANGE,
};
use sinew_anim::ik::hold_feet;
use sinew_anim::{LocalTransform, local_to_model};
use sinew_math::{Affine, Transform, Vec3, clamp, max, min, trig};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyHit, World};

/// State of a foot, apart from the height in [`Planting`](super::legs::Planting).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tread {
    /// Horizontal offset of the foot from its position in the clips, world axes, metres.
    pub offset: Vec3,
    /// Value that `offset` approaches in the air; it keeps the toes out of walls.
    pub home: Vec3,
    /// Horizontal velocity at which the clips slide the foot over the ground, m/s.
    pub slip: Vec3,
    /// Ankle and ball of the clips' foot in the last step, world.
    pub points: [Vec3; 2],
    /// Height of the ground under the foot, world, metres.
    pub ground: f32,
    /// Velocity of the ground under the foot, m/s.
    pub floor: Vec3,
    pub stands: bool,
}

/// State of both feet of a walking character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Treads {
    pub feet: [Tread; 2],
    pub level: f32,
    /// Lowering of the pelvis in the last step so that both legs reach their planted feet, metres.
    pub lowering: f32,
    /// True if the character jumps or falls, so that its feet leave the ground.
    pub aloft: bool,
}

/// A foot in the clips' pose of one step.
struct Step {
    /// Positions of ankle and ball, world.
    points: [Vec3; 2],
    /// Points below ankle and ball, and the tip of the toes, world.
    sole: [Vec3; 3],
    /// Horizontal motion of the ball over the ground, metres.
    way: Vec3,
    /// Part of this motion that is not the clip's.
    slip: Vec3,
    /// Height of the foot's lowest point above the floor of the clip, metres.
    height: f32,
}

impl Tread {
    /// Advances the foot by a step and decides whether it is planted. `size` is the height of the whole body, metres;
    /// `grounded` is true while the character has ground.
    fn go_on(&mut self, step: &Step, size: f32, grounded: bool, dt: f32) {
        let speed = step.way.length() / dt;
        // A planted foot leaves the ground only at 1.5 times these limits.
        let slack = if self.stands { 1.5 } else { 1.0 };
        let stands = grounded && step.height < slack * STANCE_HEIGHT * size && speed < slack * STANCE_SPEED;
        if stands && self.stands {
            self.offset -= step.slip;
            self.offset *= min(MOST_ASTRAY * size / max(self.offset.length(), 1e-6), 1.0);
        } else {
            self.offset = self.home + (self.offset - self.home) * trig::exp(-RELEASES * dt);
        }
        if self.offset.length_squared() < FOOT_HOME * FOOT_HOME {
            self.offset = Vec3::ZERO;
        }
        (self.stands, self.points, self.slip) = (stands, step.points, step.slip / dt);
    }
}

impl Legs {
    /// Returns ankle and ball of a foot, then the points below them and the tip of the toes, world. `model` is in the
    /// space of a character at `place`.
    fn points(&self, foot: usize, place: Transform, model: &[Affine]) -> ([Vec3; 2], [Vec3; 3]) {
        let ankle = place * model[self.chains[foot].end].to_rigid();
        ([ankle.translation, ankle.point(self.balls[foot])], self.soles[foot].map(|point| ankle.point(point)))
    }
}

impl Feet {
    /// Follows the ground for a step of a character that walks, stands or is powered.
    pub(super) fn tread(&mut self, stand: &Stand<'_>, legs: &Legs, world: &World, model: &mut Vec<Affine>) {
        let (def, figure, dt) = (stand.def, stand.figure, world.def().dt());
        let (place, level) = (figure.place, figure.place.translation.y);
        local_to_model(&def.rig, &figure.pose, &def.mapping().character_from_model(), model);
        // Transform that the character would have if it moved exactly as its clips do.
        let by_clips = figure.earlier.place * root_step(def, stand.animator);
        let is_new = self.treads.is_none();
        let mut treads = self.treads.unwrap_or(Treads { level, ..Treads::default() });
        let rise = if stand.aloft { 0.0 } else { level - treads.level };
        (treads.level, treads.aloft) = (level, stand.aloft);
        treads.lowering *= trig::exp(-PELVIS_RISES * dt);
        if treads.lowering < FOOT_HOME {
            treads.lowering = 0.0;
        }
        for (foot, tread) in treads.feet.iter_mut().enumerate() {
            let (points, sole) = legs.points(foot, place, model);
            if is_new {
                tread.points = points;
            }
            let flat = Vec3::new(1.0, 0.0, 1.0);
            let carried = tread.floor * dt;
            let step = Step {
                points,
                sole,
                way: (points[1] - tread.points[1] - carried) * flat,
                slip: (points[1] - by_clips.point(place.inverse_point(points[1])) - carried) * flat,
                height: min(sole[0].y, sole[1].y) - level,
            };
            tread.go_on(&step, def.ragdoll.height, !stand.aloft, dt);
            let mut found = stand.found(world, tread, &step, (legs.heel, dt));
            if stand.aloft {
                (found.need, found.floor) = (Need::default(), Vec3::ZERO);
            }
            tread.home = if tread.stands { Vec3::ZERO } else { found.home };
            let planting = &mut self.planting;
            let ground = level + found.need.height;
            let change = ground - tread.ground;
            // Continuous ground is followed immediately, and so is moving ground.
            let moves = max(tread.floor.y.abs(), found.floor.y.abs()) * dt;
            let goes_on = !is_new && change.abs() <= FOOT_EDGE * step.way.length() + moves;
            planting.heights[foot] += if goes_on { change } else { tread.floor.y * dt } - rise;
            (tread.ground, tread.floor) = (ground, found.floor);
            planting.follow_foot(foot, found.need, TREAD_QUICKNESS, dt);
            planting.come_to_rest(foot, found.need);
            let least = found.least(&step, level, planting.slopes[foot]) - SOLE_SINKS;
            if planting.heights[foot] < least {
                planting.heights[foot] = min(least, planting.heights[foot] + RISES * dt);
                planting.rates[foot] = max(planting.rates[foot], 0.0);
            }
        }
        self.treads = Some(treads);
    }

    /// Moves the feet of a pose of the clips, which are already at their heights, by `offsets` to their planted
    /// positions. `now` is the transform of the character after `later` seconds. Returns the lowering of the pelvis,
    /// metres.
    pub(super) fn bring_home(
        &self,
        def: &CharacterDef,
        offsets: [Vec3; 2],
        (now, later): (Transform, f32),
        pose: &mut [LocalTransform],
        model: &mut [Affine],
    ) -> f32 {
        let Some(legs) = def.legs() else { return 0.0 };
        let least = self.treads.map_or(0.0, |treads| treads.lowering * trig::exp(-PELVIS_RISES * later));
        if least == 0.0 && offsets.iter().all(|offset| offset.length_squared() < 1e-8) {
            return 0.0;
        }
        let ankles = [0, 1].map(|foot| {
            let ankle = model[legs.chains[foot].end].to_rigid();
            Transform::new(ankle.translation + now.rotation.inverse() * offsets[foot], ankle.rotation)
        });
        let most = TREAD_RANGE * def.ragdoll.height;
        hold_feet(&def.rig, legs.pelvis, &legs.chains, &ankles, [least, most], pose, model)
    }

    /// Returns the horizontal offsets of the feet from the clips' pose in `later` seconds, world axes, metres.
    pub(super) fn offsets(&self, later: f32) -> [Vec3; 2] {
        let Some(treads) = self.treads else { return [Vec3::ZERO; 2] };
        treads.feet.map(|tread| {
            let offset = match tread.stands {
                true => tread.offset - tread.slip * later,
                false => tread.home + (tread.offset - tread.home) * trig::exp(-RELEASES * later),
            };
            offset * max(1.0 - SMALL_WAY / max(offset.length(), 1e-6), 0.0)
        })
    }

    /// Returns the predicted ground under the feet, relative to the floor of the clips, for a character that will be at
    /// `now` in `later` seconds.
    pub(super) fn planting_at(&self, now: Transform, later: f32) -> super::legs::Planting {
        let mut planting = self.planting.ahead(later);
        if let Some(treads) = self.treads.filter(|treads| later > 0.0 && !treads.aloft) {
            for foot in 0..2 {
                let tread = treads.feet[foot];
                planting.heights[foot] += tread.floor.y * later - (now.translation.y - treads.level);
            }
        }
        planting
    }
}

/// Ground under a foot.
struct Found {
    need: Need,
    floor: Vec3,
    /// Heights of the ground below ankle, ball and tip of the toes over the floor of the clip, metres.
    under: [Option<f32>; 3],
    /// Level direction from ankle to ball.
    ahead: Vec3,
    /// Horizontal distance by which the toes must stay back from a wall at the landing point, metres.
    home: Vec3,
}

impl Found {
    /// Returns the least height by which the foot must be raised so that neither end is in the ground, metres.
    fn least(&self, step: &Step, level: f32, slope: f32) -> f32 {
        let flat = |end: usize| (step.sole[end] - step.points[0]) * Vec3::new(1.0, 0.0, 1.0);
        let each = (0..3).filter_map(|end| {
            let tilts = slope * flat(end).dot(self.ahead);
            // Toes bend, so their tip counts at the height of the ball at least.
            let height = if end == 2 { max(step.sole[1].y, step.sole[2].y) } else { step.sole[end].y };
            Some(self.under[end]? - (height - level) - tilts)
        });
        each.fold(f32::NEG_INFINITY, max)
    }
}

impl Stand<'_> {
    /// Finds the ground under the shown foot, and at its landing point.
    fn found(&self, world: &World, tread: &Tread, step: &Step, (heel, dt): (f32, f32)) -> Found {
        let (level, size) = (self.figure.place.translation.y, self.def.ragdoll.height);
        let under = |point: Vec3| {
            let over = Vec3::new(point.x, level, point.z);
            let hit = ground::found_below(world, over, FOOT_SEARCH, self.own)?;
            // Light bodies are not ground, because feet kick them; limbs of others are not, because feet step over
            // them.
            let is_firm = ground::is_firm(world, hit.body, LEAST_TREAD * self.def.ragdoll.total_mass);
            let over = hit.point.y - level;
            (is_firm && over <= FOOT_RANGE && over >= -TREAD_RANGE * size).then_some((over, hit))
        };
        let [ankle, ball] = step.points.map(|point| point + tread.offset);
        let tip = step.sole[2] + tread.offset;
        let flat = Vec3::new(1.0, 0.0, 1.0);
        let along = max(((ball - ankle) * flat).length(), 1e-3);
        let ahead = (ball - ankle) * flat / along;
        let found = [ankle, ball, tip].map(under);
        let heights = found.map(|found| found.map(|(height, _)| height));
        let least = |x: f32| if x.abs() < FOOT_FLOOR { 0.0 } else { x };
        let mut need = match [heights[0], heights[1]] {
            [Some(ankle), Some(ball)] if (ball - ankle).abs() <= FOOT_EDGE * along => {
                Need { height: least(ankle), slope: least(ball - ankle) / along }
            }
            heights => {
                Need { height: least(heights.into_iter().flatten().reduce(max).unwrap_or(0.0)), slope: 0.0 }
            }
        };
        let mut home = Vec3::ZERO;
        if !tread.stands {
            let [from, over] = LANDS.map(|height| height * size);
            let seconds = LOOKS_AHEAD * clamp((step.height - from) / over, 0.0, 1.0);
            let way = step.way * (seconds / dt);
            let lands = |point: Vec3| point - tread.offset + way;
            let toes = ((tip - ball) * flat).dot(ahead);
            home = ahead * self.aside(world, [lands(ankle), lands(ball)], [heel, toes], &under);
            if let Some((there, _)) = under(lands(ball) + home) {
                let way = way + home - tread.offset * flat;
                need.height += there - (need.height + need.slope * (along + way.dot(ahead)));
            }
        }
        let bearer = found[1].or(found[0]).map(|(_, hit)| hit);
        let floor = bearer.map_or(Vec3::ZERO, |hit| {
            let (velocity, arm) = (world.velocity(hit.body), hit.point - world.center_of_mass(hit.body));
            // Velocity at half of the next step.
            velocity.at(arm + velocity.at(arm) * (0.5 * dt))
        });
        Found { need, floor, under: heights, ahead, home }
    }

    /// Returns the displacement of a foot's landing position along the foot, metres. It moves the toes out of a wall,
    /// and the ball onto the step under the heel or the heel past the edge of this step. `heel` and `toes` are the
    /// lengths of the foot behind the ankle and in front of the ball.
    fn aside(
        &self,
        world: &World,
        [ankle, ball]: [Vec3; 2],
        [heel, toes]: [f32; 2],
        under: &impl Fn(Vec3) -> Option<(f32, BodyHit)>,
    ) -> f32 {
        let level = self.figure.place.translation.y;
        let way = (ball - ankle) * Vec3::new(1.0, 0.0, 1.0);
        let along = max(way.length(), 1e-3);
        let ahead = way / along;
        let (Some((back, _)), Some((front, _))) = (under(ankle), under(ball)) else { return 0.0 };
        let most = MOST_ASTRAY * self.def.ragdoll.height;
        let wall = |from: Vec3, height: f32, to: Vec3| {
            let ray = Ray { origin: Vec3::new(from.x, level + height, from.z), direction: to };
            let hit = ground::bearer(world, &ray, self.own.unwrap_or_default());
            hit.filter(|hit| hit.start.is_none() && hit.normal.y < STEEPEST_TREAD).map(|hit| hit.fraction)
        };
        if back - front > FOOT_EDGE * along {
            let over = wall(ball, back - 0.5 * TOES_OVER, -way).map_or(0.0, |share| share * along);
            let beyond = along - over + TOES_OVER;
            return if over <= beyond { -min(over, most) } else { min(beyond, most) };
        }
        let height = max(back, front) + TOES_OVER;
        let inside = |from: Vec3, to: Vec3, reach: f32| {
            let reach = reach + TOES_CLEAR;
            let share = wall(from, height, to * reach);
            share.map(|share| min(reach * (1.0 - share), most))
        };
        let before = inside(ankle, ahead, along + toes).map(|inside| -inside);
        before.or_else(|| inside(ball, -ahead, along + heel)).unwrap_or(0.0)
    }
}
