//! The policy file: its contract, writing it as ONNX, running it.
