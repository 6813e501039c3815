//! Input of commands: reads the files, scenes and settings that the arguments name.

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
