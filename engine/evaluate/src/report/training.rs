//! The page of a training, from its policy file.
