use super::quaternions::Quaternions;
use super::soa::{ROWS, SCALE, TRANSLATION};
use sinew_math::lanes::{Block, Lanes, Vector3};

/// The local transforms of a block's joints.
#[derive(Clone, Copy)]
pub(super) struct Parts<L> {
    pub translation: Vector3<L>,
    pub rotation: Quaternions<L>,
    pub scale: Vector3<L>,
}

impl<L: Lanes> Parts<L> {
    #[inline(always)]
    pub fn load(block: &Block<ROWS>) -> Self {
        let rows = &block.0;
        Self {
            translation: Vector3::load(&rows[TRANSLATION], &rows[TRANSLATION + 1], &rows[TRANSLATION + 2]),
            rotation: Quaternions::load(block),
            scale: Vector3::load(&rows[SCALE], &rows[SCALE + 1], &rows[SCALE + 2]),
        }
    }

    #[inline(always)]
    pub fn store(self, block: &mut Block<ROWS>) {
        self.rotation.store(block);
        let (t, s, rows) = (self.translation, self.scale, &mut block.0);
        t.x.store(&mut rows[TRANSLATION]);
        t.y.store(&mut rows[TRANSLATION + 1]);
        t.z.store(&mut rows[TRANSLATION + 2]);
        s.x.store(&mut rows[SCALE]);
        s.y.store(&mut rows[SCALE + 1]);
        s.z.store(&mut rows[SCALE + 2]);
    }
}
