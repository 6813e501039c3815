//! Commands from the buttons of the page around the viewer.

use super::{App, mouse};
use crate::session::Subject;

/// Command of a button on the page.
#[derive(Clone, Debug)]
pub enum Order {
    /// Pushes the subject away from the camera.
    Push,
    /// Throws a ball at the subject.
    Throw,
    /// Makes the camera follow the subject, or stand still.
    Follow,
    /// Restarts the subject.
    Restart,
    /// Pauses or continues.
    Pause,
    /// Opens another subject.
    Open(Box<Subject>),
}

impl Order {
    /// Returns the command of the button with that name.
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
    /// Executes a command.
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
