//! Shape library as bytes, for other processes.

use crate::body::library::{ENTRY_BYTES, MAGIC};
use crate::body::shape::Shape;
use crate::world::World;
use sinew_geometry::DataKind;
use sinew_math::{ReadError, Reader, Writer};

impl World {
    /// Writes every shape with data that this world has received, for another process to load before a snapshot.
    pub fn save_shapes(&self, w: &mut Writer) {
        w.raw(MAGIC);
        w.count(self.library.shapes.len());
        for shape in self.library.shapes.values() {
            let kind = shape.data_kind().expect("only shapes with data are kept");
            w.u8(kind.tag());
            w.block(|w| shape.save_data(w));
        }
    }

    /// Adds the shapes written by [`save_shapes`](Self::save_shapes) to the existing ones.
    ///
    /// # Errors
    /// If the bytes are not a library of this version or one of its shapes is invalid; the world is then unchanged.
    pub fn load_shapes(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(ReadError { at: 0, what: "is not a library of shapes of this version" });
        }
        let count = r.count(ENTRY_BYTES)?;
        let mut library = self.library.clone();
        for _ in 0..count {
            let tag = r.u8()?;
            let kind = DataKind::of_tag(tag).ok_or_else(|| r.error("unknown kind of shape"))?;
            let mut data = r.block()?;
            let shape = Shape::load_data(kind, &mut data)?;
            data.finish()?;
            let known = shape.content_hash().and_then(|hash| library.shapes.get(&hash));
            if known.is_some_and(|known| *known != shape) {
                return Err(r.error("another shape has the same hash"));
            }
            library.keep(&shape);
        }
        self.library = library;
        Ok(())
    }
}
