//! Files: reads results, computes nothing.
