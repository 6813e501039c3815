//! `--hit BONE=IX,IY,IZ@T`.

use sinew::math::Vec3;
use std::str::FromStr;

/// A push as given by the user.
#[derive(Clone, Debug, PartialEq)]
pub struct HitArg {
    /// Joint name or role of the body.
    pub bone: String,
    /// Impulse, N·s, world axes.
    pub impulse: Vec3,
    /// Time, seconds.
    pub time: f32,
}

impl FromStr for HitArg {
    type Err = String;

    /// Bone names may contain `@` and `=`, so the last one of each is the separator.
    fn from_str(text: &str) -> Result<Self, String> {
        let (rest, time) = text.rsplit_once('@').ok_or("'@T' is missing: a hit has a time")?;
        let (bone, impulse) = rest.rsplit_once('=').ok_or("'=IX,IY,IZ' is missing: a hit has an impulse")?;
        if bone.is_empty() {
            return Err("BONE is missing: a hit meets a bone".to_owned());
        }
        let numbers = impulse.split(',').map(finite).collect::<Result<Vec<_>, _>>()?;
        let [x, y, z] = numbers[..] else {
            return Err(format!("'{impulse}' must be three numbers, as in 0,0,-60"));
        };
        let time = finite(time)?;
        if time < 0.0 {
            return Err("a hit cannot come before the start".to_owned());
        }
        Ok(Self { bone: bone.to_owned(), impulse: Vec3::new(x, y, z), time })
    }
}

/// Largest number allowed in a hit; far beyond any that a body survives.
const LARGEST: f32 = 1e6;

fn finite(text: &str) -> Result<f32, String> {
    let number: f32 = text.trim().parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number.abs() <= LARGEST { Ok(number) } else { Err(format!("'{text}' is out of range")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_separators_split_the_argument() {
        let hit = |bone: &str, impulse: [f32; 3], time| {
            Ok(HitArg { bone: bone.to_owned(), impulse: Vec3::from_array(impulse), time })
        };
        assert_eq!("chest=0,0,-60@1.0".parse(), hit("chest", [0.0, 0.0, -60.0], 1.0));
        assert_eq!("a=b@2=1,2,3@0".parse(), hit("a=b@2", [1.0, 2.0, 3.0], 0.0));
        assert_eq!("rig:spine = 1e1, 0 ,.5@ 2".parse(), hit("rig:spine ", [10.0, 0.0, 0.5], 2.0));
    }

    #[test]
    fn missing_parts_are_named() {
        let refused = |text: &str, reason: &str| {
            assert_eq!(text.parse::<HitArg>(), Err(reason.to_owned()), "{text}");
        };
        refused("chest", "'@T' is missing: a hit has a time");
        refused("chest@1", "'=IX,IY,IZ' is missing: a hit has an impulse");
        refused("=1,2,3@1", "BONE is missing: a hit meets a bone");
        refused("chest=1,2@1", "'1,2' must be three numbers, as in 0,0,-60");
        refused("chest=1,x,3@1", "'x' is not a number");
        refused("chest=1,2,inf@1", "'inf' is out of range");
        refused("chest=1,2,3@-1", "a hit cannot come before the start");
        refused("chest=1,2,3@NaN", "'NaN' is out of range");
    }
}
