//! Tests of the facade as a whole.
