//! Converts values from and to JavaScript.

use crate::border::{Failure, Outcome};
use js_sys::{Array, Float32Array, Object, Reflect, Uint32Array};
use sinew::math::{Rotation, Transform, Vec3};
use wasm_bindgen::{JsCast, JsValue};

fn bad(name: &str, wanted: &str, found: &JsValue) -> Failure {
    Failure(format!("{name} must be {wanted}, not {}", shown(found)))
}

/// Formats a value for an error message.
fn shown(value: &JsValue) -> String {
    match value.as_string() {
        Some(text) => format!("'{text}'"),
        None if value.is_object() => "an object".to_owned(),
        None => format!("{value:?}").trim_start_matches("JsValue(").trim_end_matches(')').to_owned(),
    }
}

/// Returns a string, or an object as JSON.
pub fn json_text(value: &JsValue) -> Outcome<String> {
    let text = value.as_string().or_else(|| js_sys::JSON::stringify(value).ok()?.as_string());
    text.ok_or_else(|| Failure::new("settings must be a string of JSON or an object"))
}

/// Reads a finite number.
pub fn number(value: &JsValue, name: &str) -> Outcome<f32> {
    let number = value.as_f64().filter(|number| number.is_finite());
    number.map(|number| number as f32).ok_or_else(|| bad(name, "a finite number", value))
}

fn numbers<const N: usize>(value: &JsValue, name: &str, keys: [&str; N]) -> Outcome<[f32; N]> {
    let is_row = Array::is_array(value) || value.is_instance_of::<Float32Array>();
    if !value.is_object() {
        return Err(bad(name, &format!("an object with {} or an array", keys.join(", ")), value));
    }
    let mut out = [0.0; N];
    for (index, key) in keys.iter().enumerate() {
        let found = if is_row {
            Reflect::get_u32(value, index as u32)
        } else {
            Reflect::get(value, &JsValue::from_str(key))
        };
        out[index] = number(&found.unwrap_or_default(), &format!("{name}.{key}"))?;
    }
    Ok(out)
}

/// Reads `{x, y, z}` or an array of three.
pub fn vec3(value: &JsValue, name: &str) -> Outcome<Vec3> {
    numbers(value, name, ["x", "y", "z"]).map(Vec3::from_array)
}

/// Reads `{x, y, z, w}` or an array of four, of any length but 0, and normalises it.
pub fn rotation(value: &JsValue, name: &str) -> Outcome<Rotation> {
    let [x, y, z, w] = numbers(value, name, ["x", "y", "z", "w"])?;
    let rotation = Rotation { x, y, z, w };
    let length = rotation.length();
    if length.is_nan() || length < 1e-6 {
        return Err(Failure(format!("{name} must be a quaternion that is not 0")));
    }
    // A unit quaternion keeps its bits, so that setting a pose that was read changes no bits.
    Ok(if (length - 1.0).abs() < 1e-6 { rotation } else { rotation.normalize() })
}

/// Reads a bigint as the bits of an id.
pub fn id(value: &JsValue, name: &str) -> Outcome<u64> {
    let bits = value.clone().dyn_into::<js_sys::BigInt>().ok();
    bits.and_then(|bits| u64::try_from(bits).ok()).ok_or_else(|| bad(name, "an id (a bigint)", value))
}

/// Reads a `Float32Array` or an array of numbers.
pub fn floats(value: &JsValue, name: &str) -> Outcome<Vec<f32>> {
    let wanted = "a Float32Array or an array of numbers";
    let numbers = match value.dyn_ref::<Float32Array>() {
        Some(floats) => floats.to_vec(),
        None if value.is_object() => Float32Array::new(value).to_vec(),
        None => return Err(bad(name, wanted, value)),
    };
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(at) => Err(Failure(format!("{name}[{at}] must be a finite number, not {}", numbers[at]))),
    }
}

/// Reads rows of three numbers, by [`floats`].
pub fn points(value: &JsValue, name: &str) -> Outcome<Vec<Vec3>> {
    let numbers = floats(value, name)?;
    if numbers.len() % 3 != 0 {
        return Err(Failure(format!("{name} must have three numbers a point, but has {}", numbers.len())));
    }
    Ok(numbers.chunks_exact(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect())
}

/// Reads a typed array of whole numbers, or an array.
pub fn indices(value: &JsValue, name: &str) -> Outcome<Vec<u32>> {
    match value.dyn_ref::<Uint32Array>() {
        Some(indices) => Ok(indices.to_vec()),
        None if value.is_object() => Ok(Uint32Array::new(value).to_vec()),
        None => Err(bad(name, "a Uint32Array or an array of whole numbers", value)),
    }
}

/// Makes `{x, y, z}`.
pub fn vector(v: Vec3) -> JsValue {
    object([("x", v.x.into()), ("y", v.y.into()), ("z", v.z.into())])
}

/// Makes `{x, y, z, w}`.
pub fn quaternion(q: Rotation) -> JsValue {
    object([("x", q.x.into()), ("y", q.y.into()), ("z", q.z.into()), ("w", q.w.into())])
}

/// Makes `{position, rotation}`.
pub fn pose(pose: Transform) -> JsValue {
    object([("position", vector(pose.translation)), ("rotation", quaternion(pose.rotation))])
}

/// Makes an object with these fields.
pub fn object<const N: usize>(fields: [(&str, JsValue); N]) -> JsValue {
    let object = Object::new();
    for (key, value) in fields {
        // Fails only for frozen objects and proxies.
        _ = Reflect::set(&object, &JsValue::from_str(key), &value);
    }
    object.into()
}

/// An object of options from the user. Reads its fields, and rejects unknown ones.
pub struct Options<'a> {
    object: &'a JsValue,
    what: &'a str,
}

impl<'a> Options<'a> {
    /// Checks the fields of `object`; `what` is its name for messages. `undefined` and `null` have no fields.
    pub fn of(object: &'a JsValue, what: &'a str, known: &[&str]) -> Outcome<Self> {
        if !(object.is_undefined() || object.is_null() || object.is_object()) {
            return Err(bad(what, "an object", object));
        }
        if let Some(object) = object.dyn_ref::<Object>() {
            for key in Object::keys(object) {
                let key = key.as_string().unwrap_or_default();
                if !known.contains(&key.as_str()) {
                    let known = known.join(", ");
                    return Err(Failure(format!("{what} has no field '{key}'; its fields are {known}")));
                }
            }
        }
        Ok(Self { object, what })
    }

    fn name(&self, key: &str) -> String {
        format!("{}.{key}", self.what)
    }

    /// Returns a field that is neither `undefined` nor `null`.
    pub fn get(&self, key: &str) -> Option<JsValue> {
        let value = Reflect::get(self.object, &JsValue::from_str(key)).ok()?;
        (!value.is_undefined() && !value.is_null()).then_some(value)
    }

    fn read<T>(&self, key: &str, read: impl FnOnce(&JsValue, &str) -> Outcome<T>) -> Outcome<Option<T>> {
        self.get(key).map(|value| read(&value, &self.name(key))).transpose()
    }

    fn must<T>(&self, key: &str, value: Option<T>) -> Outcome<T> {
        value.ok_or_else(|| Failure(format!("{} is missing", self.name(key))))
    }

    pub fn number(&self, key: &str) -> Outcome<Option<f32>> {
        self.read(key, number)
    }

    /// Reads a finite number in double precision, for times.
    pub fn double(&self, key: &str) -> Outcome<Option<f64>> {
        self.read(key, |value, name| number(value, name).map(|_| value.as_f64().unwrap_or_default()))
    }

    /// Reads a number that may be infinite.
    pub fn bound(&self, key: &str) -> Outcome<Option<f32>> {
        self.read(key, |value, name| match value.as_f64() {
            Some(number) if !number.is_nan() => Ok(number as f32),
            _ => Err(bad(name, "a number", value)),
        })
    }

    pub fn needed_number(&self, key: &str) -> Outcome<f32> {
        let found = self.number(key)?;
        self.must(key, found)
    }

    pub fn whole(&self, key: &str) -> Outcome<Option<u32>> {
        self.read(key, |value, name| {
            let whole = value.as_f64().filter(|n| *n >= 0.0 && *n <= f64::from(u32::MAX) && n.fract() == 0.0);
            whole.map(|whole| whole as u32).ok_or_else(|| bad(name, "a whole number", value))
        })
    }

    pub fn needed_whole(&self, key: &str) -> Outcome<u32> {
        let found = self.whole(key)?;
        self.must(key, found)
    }

    pub fn flag(&self, key: &str) -> Outcome<Option<bool>> {
        self.read(key, |value, name| value.as_bool().ok_or_else(|| bad(name, "true or false", value)))
    }

    pub fn text(&self, key: &str) -> Outcome<Option<String>> {
        self.read(key, |value, name| value.as_string().ok_or_else(|| bad(name, "a string", value)))
    }

    pub fn vec3(&self, key: &str) -> Outcome<Option<Vec3>> {
        self.read(key, vec3)
    }

    pub fn needed_vec3(&self, key: &str) -> Outcome<Vec3> {
        let found = self.vec3(key)?;
        self.must(key, found)
    }

    pub fn rotation(&self, key: &str) -> Outcome<Option<Rotation>> {
        self.read(key, rotation)
    }

    pub fn id(&self, key: &str) -> Outcome<Option<u64>> {
        self.read(key, id)
    }

    pub fn needed_id(&self, key: &str) -> Outcome<u64> {
        let found = self.id(key)?;
        self.must(key, found)
    }

    pub fn points(&self, key: &str) -> Outcome<Vec<Vec3>> {
        let found = self.read(key, points)?;
        self.must(key, found)
    }

    pub fn floats(&self, key: &str) -> Outcome<Vec<f32>> {
        let found = self.read(key, floats)?;
        self.must(key, found)
    }

    pub fn indices(&self, key: &str) -> Outcome<Vec<u32>> {
        let found = self.read(key, indices)?;
        self.must(key, found)
    }

    /// Reads a word in a list; returns its index.
    pub fn word(&self, key: &str, words: &[&str]) -> Outcome<Option<usize>> {
        self.read(key, |value, name| {
            let found = value.as_string().and_then(|text| words.iter().position(|word| *word == text));
            found.ok_or_else(|| bad(name, &format!("one of {}", words.join(", ")), value))
        })
    }

    pub fn needed_word(&self, key: &str, words: &[&str]) -> Outcome<usize> {
        let found = self.word(key, words)?;
        self.must(key, found)
    }
}
