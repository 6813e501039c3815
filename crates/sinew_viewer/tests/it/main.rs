//! Integration tests of the viewer: pictures by the driver that is there, panels and hands without a window, a window under Xvfb.

mod chase;
mod editor;
mod endurance;
mod files;
mod hands;
mod kept;
mod pictures;
mod timeline;
