//! Unpublished: statistical, conformance and end-to-end tests of the workspace live in this member's `tests/` folder.
