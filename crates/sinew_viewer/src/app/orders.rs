//! Orders of the page around the viewer: what its buttons do.

use super::{App, mouse};
use crate::session::Subject;

/// Order of a page.
#[derive(Clone, Debug)]
pub enum Order {
    /// Pushes the subject away from the camera.
    Push,
    /// Throws a ball at the subject.
    Throw,
    /// Has the camera go along with the subject, or stand still.
    Follow,
    /// Starts again.
    Restart,
    /// Pauses, or goes on.
    Pause,
    /// Opens another subject.
    Open(Box<Subject>),
}

impl Order {
    /// The order of a button's name.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "push" => Self::Push,
            "throw" => Self::Throw,
            "follow" => Self::Follow,
            "restart" => Self::Restart,
            "pause" => Self::Pause,
            _ => return None,
        })
    }
}

impl App {
    /// Does what the page asks for.
    pub fn obey(&mut self, order: Order) {
        match order {
            Order::Push => mouse::push_subject(self),
            Order::Throw => mouse::throw(self, None),
            Order::Follow => {
                self.follow(self.follows.is_none());
                if self.is_following() {
                    self.frame();
                }
            }
            Order::Restart => {
                self.restart();
                self.running = true;
            }
            Order::Pause => self.running = !self.running,
            Order::Open(subject) => {
                self.open(*subject);
                self.running = true;
            }
        }
    }
}
