//! Copies the results of blocks back to the world's contacts.

use super::Contacts;
use super::block::{Block, Memory, NONE, Rolling};
use super::refresh::Found;
use crate::contact::{ContactMemory, PointImpulse};
use crate::solver::boundary::solution::SolvedContact;
use crate::solver::contacts::classes::Class;
use crate::solver::piles::touch::Touch;
use crate::spatial::Vec6;
use sinew_math::Vec3;
use sinew_math::lanes::WIDTH;

/// Returns the vector of a lane.
fn vector(rows: &[[f32; WIDTH]; 3], lane: usize) -> Vec3 {
    Vec3::new(rows[0][lane], rows[1][lane], rows[2][lane])
}

/// Returns the impulses that a lane's contact keeps, converted to substeps `times` as long.
pub(super) fn memory_of<const N: usize, const T: usize>(
    block: &Block<N, T>,
    memory: &Memory<N>,
    rolling: &[Rolling],
    lane: usize,
    times: f32,
) -> ContactMemory {
    let mut of = ContactMemory::default();
    for i in 0..N {
        of.points[i] = PointImpulse {
            now: block.impulse[i][lane] * times,
            before: memory.before[i][lane] * times,
            total: memory.total[i][lane],
            lasting: memory.lasting[i][lane] * times,
        };
    }
    let (n, t0) = (vector(&block.normal, lane), vector(&block.tangent, lane));
    let t1 = n.cross(t0);
    of.friction = (t0 * block.friction[0][lane] + t1 * block.friction[1][lane]) * times;
    of.total_friction = t0 * memory.total_friction[0][lane] + t1 * memory.total_friction[1][lane];
    of.twist = block.twist[lane] * times;
    if let Some(rolling) = rolling.get(block.rolling as usize) {
        of.rolling = vector(&rolling.impulse, lane) * times;
    }
    of
}

impl<const N: usize, const T: usize> Class<N, T> {
    /// Lanes with contacts: block and lane of each.
    fn lanes(&self) -> impl Iterator<Item = (usize, usize)> {
        let used =
            move |place: usize| (0..WIDTH).filter(move |&lane| self.memory[place].contacts[lane] != NONE);
        (0..self.count).flat_map(move |place| used(place).map(move |lane| (place, lane)))
    }

    /// Writes the contacts of the class to `room`.
    fn store(
        &self,
        (class, stretch): (u32, f32),
        of: &Contacts,
        room: &mut core::slice::IterMut<'_, SolvedContact>,
    ) {
        // The recomputed manifolds of this class, in order of their lanes.
        let mut found = of.found.iter().skip_while(|found| found.class() < class).peekable();
        for (place, lane) in self.lanes() {
            let index = self.memory[place].contacts[lane];
            let Some(solved) = room.next() else { return };
            let memory =
                memory_of(&self.blocks[place], &self.memory[place], &of.rolling, lane, 1.0 / stretch);
            let anew = found.next_if(|found| found.contact() == index);
            *solved = SolvedContact { index, found: anew.map(Found::manifold), memory };
        }
    }

    fn list_pushes(&self, touches: &mut Vec<Touch>) {
        for (place, lane) in self.lanes() {
            let block = &self.blocks[place];
            let load = block.impulse.iter().fold(0.0, |sum, row| sum + row[lane]);
            let bodies = [0, 1].map(|end| block.bodies[end][lane] & !super::block::HELD);
            touches.push(Touch::pressing(bodies, vector(&block.normal, lane), load));
        }
    }

    /// Work that kinematic bodies do through the contacts of the class in this substep, J.
    fn work_on_held(&self, rolling: &[Rolling], velocities: &[Vec6], moving: usize) -> f32 {
        let mut given = 0.0;
        for (place, lane) in self.lanes() {
            let block = &self.blocks[place];
            for end in 0..2 {
                let body = (block.bodies[end][lane] & !super::block::HELD) as usize;
                if body < moving || velocities[body] == crate::spatial::ZERO6 {
                    continue;
                }
                let (push, torque) = push_on(block, rolling, lane, end);
                let v = &velocities[body];
                given -= push.dot(crate::spatial::linear(v)) + torque.dot(crate::spatial::angular(v));
            }
        }
        given
    }
}

/// Returns impulse and torque on body A (`end` 0) or B of a lane in this substep.
fn push_on<const N: usize, const T: usize>(
    block: &Block<N, T>,
    rolling: &[Rolling],
    lane: usize,
    end: usize,
) -> (Vec3, Vec3) {
    let (n, t0) = (vector(&block.normal, lane), vector(&block.tangent, lane));
    let shift = if end == 0 { Vec3::ZERO } else { vector(&block.offset, lane) };
    let (mut push, mut torque) = (Vec3::ZERO, n * block.twist[lane]);
    for i in 0..N {
        let impulse = n * block.impulse[i][lane];
        push += impulse;
        torque += (vector(&block.arms[i], lane) + shift).cross(impulse);
    }
    let friction = t0 * block.friction[0][lane] + n.cross(t0) * block.friction[1][lane];
    push += friction;
    torque += (vector(&block.center, lane) + shift).cross(friction);
    if let Some(rolling) = rolling.get(block.rolling as usize) {
        torque += vector(&rolling.impulse, lane);
    }
    let sign = if end == 0 { -1.0 } else { 1.0 };
    (push * sign, torque * sign)
}

impl Contacts {
    /// Writes the state that contacts keep for the next step to `room`, from substeps `stretch` times as long as the
    /// world's.
    pub fn store(&self, stretch: f32, room: &mut [SolvedContact]) {
        let mut room = room.iter_mut();
        self.one.store((0, stretch), self, &mut room);
        self.two.store((1, stretch), self, &mut room);
        self.four.store((2, stretch), self, &mut room);
    }

    /// Adds the touching pairs and their normal impulses in this substep.
    pub fn list_pushes(&self, touches: &mut Vec<Touch>) {
        self.one.list_pushes(touches);
        self.two.list_pushes(touches);
        self.four.list_pushes(touches);
    }

    /// Work that kinematic bodies do by pushing in this substep, J.
    pub fn work_of_kinematic(&self, velocities: &[Vec6], moving: usize) -> f32 {
        self.one.work_on_held(&self.rolling, velocities, moving)
            + self.two.work_on_held(&self.rolling, velocities, moving)
            + self.four.work_on_held(&self.rolling, velocities, moving)
    }

    /// Clears all impulses.
    pub fn forget(&mut self) {
        self.one.forget();
        self.two.forget();
        self.four.forget();
        for rolling in &mut self.rolling {
            rolling.impulse = [[0.0; WIDTH]; 3];
        }
    }
}

impl<const N: usize, const T: usize> Class<N, T> {
    fn forget(&mut self) {
        for block in &mut self.blocks[..self.count] {
            block.impulse = [[0.0; WIDTH]; N];
            block.friction = [[0.0; WIDTH]; 2];
            block.twist = [0.0; WIDTH];
        }
    }
}
