//! Formats at the edge.
