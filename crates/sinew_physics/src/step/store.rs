//! The stage `store` writes the islands' impulses to the world.

use crate::arena::Arena;
use crate::contact::Contact;
use crate::contact::disabled_pairs::DisabledPairs;
use crate::contact::events::Events;
use crate::context::StepContext;
use crate::joint::Joint;
use crate::joint::def::JointState;
use crate::particles::ParticleGroup;
use crate::solver::SolvedJoint;
use crate::step::islands::Islands;

/// `store`: writes impulses and joint forces for the next step. Particle groups return to the world; non-finite ones
/// are rolled back. Overloaded joints break.
pub(crate) fn store(
    islands: &mut Islands,
    joints: &mut Arena<Joint>,
    parted: &mut DisabledPairs,
    contacts: &mut [Contact],
    groups: &mut Arena<ParticleGroup>,
    events: &mut Events,
    context: &StepContext<'_>,
) {
    islands.release(groups);
    events.rolled_back.clear();
    for (id, group) in groups.entries_mut() {
        if group.is_awake() && group.roll_back() {
            events.rolled_back.push(id);
        }
    }
    let solution = islands.solution();
    for solved in &solution.contacts {
        let contact = &mut contacts[solved.index as usize];
        if let Some(manifold) = solved.found {
            let of_solved = manifold.points().iter().map(|point| point.feature);
            if contact.manifold.points().iter().map(|point| point.feature).ne(of_solved) {
                contact.kept.drop();
            }
            contact.manifold = manifold;
        }
        contact.memory = solved.memory;
    }
    events.broken.clear();
    for &SolvedJoint { index, limits, force, warm_impulse, saturated, mass, reaction } in &solution.joints {
        let id = joints.id(index);
        let joint = joints.at_mut(index);
        joint.limits = limits;
        joint.force = force;
        joint.warm_impulse = warm_impulse;
        joint.saturated = saturated;
        joint.mass = mass;
        joint.reaction = reaction.map(|impulse| impulse / context.dt);
        if joint.is_overloaded() {
            joint.state = JointState::Disabled;
            events.broken.push(id);
        }
    }
    if !events.broken.is_empty() {
        events.broken.sort_unstable();
        parted.invalidate();
    }
}
