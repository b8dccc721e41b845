//! Levels: the elevations that lines are drawn at.
