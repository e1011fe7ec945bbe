//! Real roots.
