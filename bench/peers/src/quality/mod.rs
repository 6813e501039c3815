//! What the time of a run bought.
