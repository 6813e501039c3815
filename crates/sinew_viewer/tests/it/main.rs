//! Integration tests of the viewer: pictures by the present driver, panels and input without a window, a window under Xvfb.

mod editor;
mod endurance;
mod files;
mod hands;
mod kept;
mod pictures;
mod timeline;
