//! Step size and trajectory length by trial (on the first frame; both are then fixed).
