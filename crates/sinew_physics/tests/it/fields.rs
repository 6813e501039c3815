//! Fields and forces against closed forms.

mod closed_forms;
mod forces;
mod sheets;
mod state;
