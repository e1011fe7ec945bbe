//! octray
