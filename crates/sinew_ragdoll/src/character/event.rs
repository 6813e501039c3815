//! States and events of a character.

use sinew_anim::FiredEvent;
use sinew_math::{ReadError, Reader, Writer};
use sinew_physics::BodyId;

/// State of a character, which determines the source of its pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Clips determine the pose; they move the character's bodies, if it has any in the world.
    Animated,
    /// Bodies determine the pose: the character falls, or lies.
    Limp,
    /// Bodies determine the pose; they are driven to the start of a get-up clip.
    Preparing,
    /// A get-up clip determines the pose, after a blend from the pose and motion of the bodies.
    GettingUp,
    /// Clips determine the pose, except for a struck limb that returns to them.
    Flinching,
    /// Bodies determine the pose; muscles and pins drive them to the clips.
    Powered,
}

/// An event of a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CharacterEvent {
    /// The character was pushed.
    Hit {
        /// Index of the body in the definition.
        body: usize,
    },
    /// One of the character's bodies was struck: by a contact, or by a blast or another impulse on bodies that clips
    /// move.
    Struck {
        /// Index of the body in the definition; if several were struck, the one struck hardest.
        body: usize,
        /// Impulse, N·s; of a blast the sum over the character's bodies.
        impulse: f32,
    },
    /// A hit did not make the character fall: the limb is weak and returns.
    Flinched {
        /// Index of the struck body in the definition.
        body: usize,
    },
    /// The limb follows the clips again.
    Recovered,
    /// Muscles and pins drive the character from now on.
    Powered,
    /// An event of a clip that determines the pose ([`MotionSet::events`](super::MotionSet::events)); its name is
    /// [`AnimationSet::event`](sinew_anim::AnimationSet::event) of [`CharacterDef::set`](super::CharacterDef::set).
    Clip(FiredEvent),
    /// One of the character's bodies began or stopped touching another's body, if
    /// [`InWorld::tells_contacts`](super::InWorld::tells_contacts) is set.
    Contact {
        /// Index of the character's body in the definition.
        body: usize,
        /// The other's body.
        other: BodyId,
        /// True if the contact began, false if it ended.
        begins: bool,
    },
    /// The character released a held body, or the body was torn off.
    LetGo {
        /// Index of the holding body in the definition.
        body: usize,
        /// Body that was held.
        held: BodyId,
    },
    /// The character starts stepping to catch a push.
    Stumbled,
    /// The steps stopped the fall; the character's feet follow the clips again.
    Caught {
        /// Number of steps, except those that only returned the feet.
        steps: u32,
    },
    /// A limb was detached.
    Detached {
        /// Index in the definition of the limb's first body, at the cut.
        body: usize,
    },
    /// The character went limp.
    WentLimp,
    /// One of the bodies touched the world for the first time since the character went limp.
    Touched,
    /// The character lies still.
    Settled {
        /// World time at which the character began to lie still, seconds.
        since: f32,
    },
    /// The character did not come to rest in the given time.
    NeverSettled,
    /// The pose of the lying character differs from the start of all get-up clips, so it is driven to the nearest one.
    Preparing {
        /// True if the character must be rolled over.
        rolls: bool,
    },
    /// The character began to get up.
    GettingUp {
        /// Index of the clip; `None`: no clip fits, and the character fades to standing.
        clip: Option<usize>,
    },
    /// The character is animated again.
    Up,
}

impl CharacterEvent {
    /// Writes an event that a call caused and no update has reported. Events of clips are reported by the update in
    /// which they occur.
    pub(super) fn save(&self, w: &mut Writer) {
        let (tag, numbers): (u8, [u64; 2]) = match *self {
            Self::Hit { body } => (0, [body as u64, 0]),
            Self::Struck { body, impulse } => (1, [body as u64, u64::from(impulse.to_bits())]),
            Self::Flinched { body } => (2, [body as u64, 0]),
            Self::Recovered => (3, [0; 2]),
            Self::Powered => (4, [0; 2]),
            Self::Contact { body, other, begins } => (5 + u8::from(begins), [body as u64, other.to_bits()]),
            Self::LetGo { body, held } => (7, [body as u64, held.to_bits()]),
            Self::Stumbled => (8, [0; 2]),
            Self::Caught { steps } => (9, [u64::from(steps), 0]),
            Self::Detached { body } => (10, [body as u64, 0]),
            Self::WentLimp => (11, [0; 2]),
            Self::Touched => (12, [0; 2]),
            Self::Settled { since } => (13, [u64::from(since.to_bits()), 0]),
            Self::NeverSettled => (14, [0; 2]),
            Self::Preparing { rolls } => (15, [u64::from(rolls), 0]),
            Self::GettingUp { clip } => (16, [clip.map_or(0, |clip| clip as u64 + 1), 0]),
            Self::Up => (17, [0; 2]),
            Self::Clip(_) => unreachable!("the update in which a clip's event occurs reports it"),
        };
        w.u8(tag);
        numbers.into_iter().for_each(|number| w.u64(number));
    }

    /// Reads an event written by [`save`](Self::save).
    pub(super) fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let (tag, first, second) = (r.u8()?, r.u64()?, r.u64()?);
        let (body, id) = (first as usize, BodyId::from_bits(second));
        Ok(match tag {
            0 => Self::Hit { body },
            1 => Self::Struck { body, impulse: f32::from_bits(second as u32) },
            2 => Self::Flinched { body },
            3 => Self::Recovered,
            4 => Self::Powered,
            5 | 6 => Self::Contact { body, other: id, begins: tag == 6 },
            7 => Self::LetGo { body, held: id },
            8 => Self::Stumbled,
            9 => Self::Caught { steps: first as u32 },
            10 => Self::Detached { body },
            11 => Self::WentLimp,
            12 => Self::Touched,
            13 => Self::Settled { since: f32::from_bits(first as u32) },
            14 => Self::NeverSettled,
            15 => Self::Preparing { rolls: first != 0 },
            16 => Self::GettingUp { clip: first.checked_sub(1).map(|clip| clip as usize) },
            17 => Self::Up,
            _ => return Err(r.error("unknown event of a character")),
        })
    }
}

/// Unreported events of a character, and the events of its last update.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    pub list: Vec<CharacterEvent>,
    /// Number of events at the end of the last update.
    told: usize,
}

impl Events {
    pub fn push(&mut self, event: CharacterEvent) {
        self.list.push(event);
    }

    /// Discards the events of the last update.
    pub fn begin(&mut self) {
        self.list.drain(..self.told);
    }

    /// Returns the events caused by calls since the last update.
    pub fn untold(&self) -> &[CharacterEvent] {
        &self.list[self.told..]
    }

    /// Ends an update.
    pub fn end(&mut self) {
        self.told = self.list.len();
    }

    pub fn clear(&mut self) {
        self.list.clear();
        self.told = 0;
    }
}
