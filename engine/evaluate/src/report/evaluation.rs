//! The page of an evaluation, from the JSON that `evaluate` prints.
