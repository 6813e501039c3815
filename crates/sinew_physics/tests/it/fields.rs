//! Fields and forces, compared with closed forms.

mod closed_forms;
mod forces;
mod sheets;
mod state;
