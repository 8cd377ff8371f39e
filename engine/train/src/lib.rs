//! The surrogate MDP over belief summaries and PPO.
