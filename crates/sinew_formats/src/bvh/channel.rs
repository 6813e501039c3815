//! Channels of a joint: the meaning of each number in a row.

use sinew_math::Vec3;

/// One of the six degrees of freedom of a BVH joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BvhChannel {
    /// Translation along x.
    Xposition,
    /// Translation along y.
    Yposition,
    /// Translation along z.
    Zposition,
    /// Rotation about x, degrees.
    Xrotation,
    /// Rotation about y, degrees.
    Yrotation,
    /// Rotation about z, degrees.
    Zrotation,
}

impl BvhChannel {
    /// All six channels.
    pub const ALL: [Self; 6] = [
        Self::Xposition,
        Self::Yposition,
        Self::Zposition,
        Self::Xrotation,
        Self::Yrotation,
        Self::Zrotation,
    ];

    /// The three position channels.
    pub const POSITIONS: [Self; 3] = [Self::Xposition, Self::Yposition, Self::Zposition];

    /// Returns the rotation about axis 0, 1 or 2.
    ///
    /// # Panics
    /// If the axis does not exist.
    pub fn rotation(axis: usize) -> Self {
        Self::ALL[3 + axis]
    }

    /// The channel's keyword in a file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xposition => "Xposition",
            Self::Yposition => "Yposition",
            Self::Zposition => "Zposition",
            Self::Xrotation => "Xrotation",
            Self::Yrotation => "Yrotation",
            Self::Zrotation => "Zrotation",
        }
    }

    /// Returns the channel of that name, in any case.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|channel| channel.name().eq_ignore_ascii_case(name))
    }

    /// True for a rotation, false for a translation.
    pub fn is_rotation(self) -> bool {
        self >= Self::Xrotation
    }

    /// Returns the axis: 0, 1, 2 for x, y, z.
    pub fn axis(self) -> usize {
        self as usize % 3
    }

    /// Returns the unit vector along or about which the channel moves.
    pub fn direction(self) -> Vec3 {
        Vec3::AXES[self.axis()]
    }
}
