//! Curves of small scenes, against what is computed by hand.
