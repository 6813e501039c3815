//! States of a character, and what it tells of.

use sinew_anim::FiredEvent;
use sinew_physics::BodyId;

/// State of a character: what decides its pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Clips; they lead its bodies, if it has any in the world.
    Animated,
    /// Its bodies: it falls, or lies.
    Limp,
    /// Its bodies, which are brought to where a get-up clip begins.
    Preparing,
    /// A get-up clip, in which the pose and the motion of the bodies die away.
    GettingUp,
    /// Clips, but for a limb that was struck and comes back to them.
    Flinching,
    /// Its bodies, which muscles and pins draw to its clips.
    Powered,
}

/// Something that happened to a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CharacterEvent {
    /// It was pushed.
    Hit {
        /// Index of the body in the definition.
        body: usize,
    },
    /// Something struck one of its bodies: contacts tell more.
    Struck {
        /// Index of the body in the definition.
        body: usize,
        /// N·s.
        impulse: f32,
    },
    /// A blow did not fell it: the limb gives way and comes back.
    Flinched {
        /// Index of the struck body in the definition.
        body: usize,
    },
    /// Its limb is as the clips have it again.
    Recovered,
    /// Muscles and pins hold it from now on.
    Powered,
    /// A moment of a clip came by that decides its pose ([`MotionSet::events`](super::MotionSet::events)); the name is [`AnimationSet::event`](sinew_anim::AnimationSet::event) of
    /// [`CharacterDef::set`](super::CharacterDef::set).
    Clip(FiredEvent),
    /// One of its bodies began or stopped to touch a body that is not its own: where [`InWorld::tells_contacts`](super::InWorld::tells_contacts) says so.
    Contact {
        /// Index of its body in the definition.
        body: usize,
        /// The other.
        other: BodyId,
        /// False: they parted.
        begins: bool,
    },
    /// It let go of what one of its bodies held, or that was torn off.
    LetGo {
        /// Index of its body in the definition.
        body: usize,
        /// Body that was held.
        held: BodyId,
    },
    /// A push would have it over: it begins to step.
    Stumbled,
    /// Its steps caught it; its feet are as its clips have them again.
    Caught {
        /// Number of steps beside those that only brought its feet home.
        steps: u32,
    },
    /// A limb was cut off.
    Detached {
        /// Index in the definition of the body where it was cut, which went with it.
        body: usize,
    },
    /// Its bodies took over.
    WentLimp,
    /// The first of its bodies touched something of the world since it went limp.
    Touched,
    /// It lies still.
    Settled {
        /// When it began to lie still, seconds of the world's time.
        since: f32,
    },
    /// It did not come to rest in the time it was given.
    NeverSettled,
    /// It lies otherwise than its get-up clips begin, and is brought to where the nearest does.
    Preparing {
        /// True if it has to be rolled over.
        rolls: bool,
    },
    /// It began to get up.
    GettingUp {
        /// Index of the clip; `None`: it has none that fits, and fades to standing.
        clip: Option<usize>,
    },
    /// It is animated again.
    Up,
}

/// Events of a character that were not told yet, and those of its last update.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    pub list: Vec<CharacterEvent>,
    /// Number of events that were there at the end of the last update.
    told: usize,
}

impl Events {
    pub fn push(&mut self, event: CharacterEvent) {
        self.list.push(event);
    }

    /// Forgets what was there at the end of the last update.
    pub fn begin(&mut self) {
        self.list.drain(..self.told);
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
