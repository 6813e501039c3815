//! Grab points, such as for a mouse or a crane.

use crate::border::{Outcome, Shared};
use crate::character::grab_of;
use crate::definitions::body;
use crate::inner::Inner;
use crate::types::{GrabOptions, Vec3Like};
use crate::values::vec3;
use crate::world::World;
use sinew::ragdoll::Grab;
use wasm_bindgen::prelude::*;

/// A point in the world that grabs a body or a limb and drags it to a target with a limited force.
#[wasm_bindgen]
pub struct GrabPoint {
    inner: Shared<Inner>,
    serial: u64,
}

#[wasm_bindgen]
impl World {
    /// Grabs a dynamic body at a point in the world; `undefined` if the point is out of reach, or no force moves the
    /// body.
    pub fn grab(&self, id: u64, point: Vec3Like, options: Option<GrabOptions>) -> Outcome<Option<GrabPoint>> {
        let (point, grab) = (vec3(&point, "point")?, grab_of(options, Grab::POINT)?);
        let serial = self.inner.change(|inner| {
            let body = body(&inner.world, id)?;
            let taken = sinew::ragdoll::GrabPoint::take(&mut inner.world, body, point, &grab);
            Ok(taken.map(|taken| inner.settle_grab(taken)))
        })?;
        Ok(serial.map(|serial| GrabPoint { inner: self.inner.clone(), serial }))
    }
}

#[wasm_bindgen]
impl GrabPoint {
    /// Moves the target of the grab point.
    #[wasm_bindgen(js_name = setTarget)]
    pub fn set_target(&self, point: Vec3Like) -> Outcome {
        let point = vec3(&point, "point")?;
        self.inner.change(|inner| {
            if let Some(Some(grab)) = inner.grab_place(self.serial).map(|place| &mut inner.grabs[place]) {
                grab.point.set_target(point);
            }
            Ok(())
        })
    }

    /// True while the grab point holds a body.
    #[wasm_bindgen(getter)]
    pub fn holds(&self) -> Outcome<bool> {
        self.inner.read(|inner| Ok(inner.grab_place(self.serial).is_some()))
    }

    /// Releases the held body.
    pub fn release(&self) -> Outcome {
        self.inner.change(|inner| {
            if let Some(grab) = inner.grab_place(self.serial).and_then(|place| inner.grabs[place].take()) {
                grab.point.release(&mut inner.world);
            }
            Ok(())
        })
    }
}
