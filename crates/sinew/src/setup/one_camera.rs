//! One camera.
