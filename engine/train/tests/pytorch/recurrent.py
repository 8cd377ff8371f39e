"""Logits, values and gradients of recurrent PPO's loss in PyTorch, in double precision.

Reads lines of a name and numbers from standard input and writes such lines to standard output.
Exits with 3 where PyTorch is not installed.
"""

import sys

try:
    import torch
except ImportError:
    sys.exit(3)

torch.set_default_dtype(torch.float64)
torch.set_num_threads(1)


def read_arrays():
    lines = (line.split() for line in sys.stdin)
    return {name: [float(number) for number in numbers] for name, *numbers in lines}


def write(name, tensor):
    print(name, *tensor.detach().flatten().tolist())


arrays = read_arrays()
copies, length, features, actions, layers, width = map(int, arrays["sizes"])
clip_range, entropy_coefficient, value_coefficient = arrays["coefficients"]


def sequences(name, *shape):
    return torch.tensor(arrays[name]).reshape(copies, length, *shape)


class Network:
    """torch.nn.LSTM and the perceptron above it, with the weights of the question."""

    def __init__(self, name):
        self.name = name
        self.lstm = torch.nn.LSTM(features, width, layers)
        self.parameters = []
        parts = ("weight_ih_l", "weight_hh_l", "bias_ih_l")
        for layer in range(layers):
            for part in parts:
                self.load(getattr(self.lstm, f"{part}{layer}"))
            torch.nn.init.zeros_(getattr(self.lstm, f"bias_hh_l{layer}"))
        self.dense = []
        inputs = width
        while f"{name}_{len(self.parameters)}" in arrays:
            outputs = len(arrays[f"{name}_{len(self.parameters) + 1}"])
            linear = torch.nn.Linear(inputs, outputs)
            self.load(linear.weight)
            self.load(linear.bias)
            self.dense.append(linear)
            inputs = outputs

    def load(self, parameter):
        numbers = arrays[f"{self.name}_{len(self.parameters)}"]
        with torch.no_grad():
            parameter.copy_(torch.tensor(numbers).reshape(parameter.shape))
        self.parameters.append(parameter)

    def forward(self):
        """Outputs [copy][step][output]; episodes start with states of 0."""
        states = torch.tensor(arrays[f"{self.name}_states"])
        states = states.reshape(copies, layers, 2, width).permute(2, 1, 0, 3)
        hidden, cell = states[0].contiguous(), states[1].contiguous()
        inputs, starts = sequences("features", features), sequences("starts")
        results = []
        for step in range(length):
            kept = (1.0 - starts[:, step]).reshape(1, copies, 1)
            one = inputs[:, step].unsqueeze(0)
            result, (hidden, cell) = self.lstm(one, (hidden * kept, cell * kept))
            results.append(result.squeeze(0))
        values = torch.stack(results, dim=1)
        for linear in self.dense[:-1]:
            values = torch.tanh(linear(values))
        return self.dense[-1](values)

    def write_gradients(self):
        for index, parameter in enumerate(self.parameters):
            write(f"{self.name}_gradient_{index}", parameter.grad)


policy, value = Network("policy"), Network("value")
logits, values = policy.forward(), value.forward().squeeze(-1)

allowed = sequences("allowed", actions) > 0.5
distribution = torch.distributions.Categorical(logits=logits.masked_fill(~allowed, -1e30))
ratio = torch.exp(
    distribution.log_prob(sequences("taken")) - sequences("log_probabilities")
)
advantages = sequences("advantages")
advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
clipped = torch.clamp(ratio, 1.0 - clip_range, 1.0 + clip_range)
policy_loss = -torch.min(advantages * ratio, advantages * clipped).mean()
entropy_loss = -distribution.entropy().mean()
value_loss = torch.nn.functional.mse_loss(values, sequences("returns"))
loss = policy_loss + entropy_coefficient * entropy_loss + value_coefficient * value_loss
loss.backward()

write("logits", logits)
write("values", values)
policy.write_gradients()
value.write_gradients()
