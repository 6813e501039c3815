//! Input of commands: files, scenes and settings given as arguments.

pub(crate) mod files;
pub(crate) mod kin;
pub(crate) mod motion;
pub(crate) mod onto;
pub(crate) mod picture_file;
pub(crate) mod ragdoll_file;
pub(crate) mod scene_choice;
pub(crate) mod settings_arg;
pub(crate) mod skeleton;
pub(crate) mod source;
