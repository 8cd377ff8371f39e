//! The model: object file, joint, actions, observation, reward, belief, controller.
