//! TypeScript types of the objects exchanged with JavaScript.

use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = include_str!("types.d.ts");

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(typescript_type = "Vec3Like")]
    pub type Vec3Like;
    #[wasm_bindgen(typescript_type = "QuatLike")]
    pub type QuatLike;
    #[wasm_bindgen(typescript_type = "Vec3")]
    pub type Vec3Out;
    #[wasm_bindgen(typescript_type = "Pose")]
    pub type PoseOut;
    #[wasm_bindgen(typescript_type = "Velocity")]
    pub type VelocityOut;
    #[wasm_bindgen(typescript_type = "PhysicsEvent[]")]
    pub type Events;
    #[wasm_bindgen(typescript_type = "WorldOptions")]
    pub type WorldOptions;
    #[wasm_bindgen(typescript_type = "BodyOptions")]
    pub type BodyOptions;
    #[wasm_bindgen(typescript_type = "ShapeOptions")]
    pub type ShapeOptions;
    #[wasm_bindgen(typescript_type = "JointOptions")]
    pub type JointOptions;
    #[wasm_bindgen(typescript_type = "MotorOptions")]
    pub type MotorOptions;
    #[wasm_bindgen(typescript_type = "QueryOptions")]
    pub type QueryOptions;
    #[wasm_bindgen(typescript_type = "Hit")]
    pub type HitOut;
    #[wasm_bindgen(typescript_type = "Hit[]")]
    pub type Hits;
    #[wasm_bindgen(typescript_type = "{ positions: Float32Array; colors: Float32Array }")]
    pub type LinesOut;
    #[wasm_bindgen(typescript_type = "RopeOptions")]
    pub type RopeOptions;
    #[wasm_bindgen(typescript_type = "ClothOptions")]
    pub type ClothOptions;
    #[wasm_bindgen(typescript_type = "SoftBallOptions")]
    pub type SoftBallOptions;
    #[wasm_bindgen(typescript_type = "CharacterOptions")]
    pub type CharacterOptions;
    #[wasm_bindgen(typescript_type = "CharacterState")]
    pub type StateOut;
    #[wasm_bindgen(typescript_type = "CharacterPreset")]
    pub type PresetName;
    #[wasm_bindgen(typescript_type = "CharacterDetail")]
    pub type DetailName;
    #[wasm_bindgen(typescript_type = "DriveMode")]
    pub type DriveOptions;
    #[wasm_bindgen(typescript_type = "HoldOptions")]
    pub type HoldOptions;
    #[wasm_bindgen(typescript_type = "GrabOptions")]
    pub type GrabOptions;
    #[wasm_bindgen(typescript_type = "PlayOptions")]
    pub type PlayOptions;
    #[wasm_bindgen(typescript_type = "string[]")]
    pub type Names;
}
