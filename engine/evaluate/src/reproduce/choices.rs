//! What the paper leaves open, and what was chosen.

/// Something the paper does not say, or says in two ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// What is open.
    pub open: &'static str,
    /// What was chosen, and why.
    pub chosen: &'static str,
}

/// All of them, in the order of the paper's sections.
pub const CHOICES: [Choice; 25] = [
    Choice {
        open: "The goal tolerance \u{3b5}_g of (2)",
        chosen: "It stands in each object file, as goal_tolerance_deg or goal_tolerance_m, and \
                 is part of the task hash of a policy.",
    },
    Choice {
        open: "The hyperparameters",
        chosen: "Not the paper's (stable-baselines3's defaults with a learning rate from 1e-4, \
                 here recipe `paper`), which leave PuBS under-trained within the same steps. \
                 Policies on a belief get `standard` (the benchmarks `benchmark`, the same with \
                 twice the steps), policies on raw observations `baseline`; both with ten times \
                 the learning rate and an entropy bonus that ends at 0. Each row of the table of \
                 cells names its recipe. PPO with `standard` was tried on two of the twelve cells \
                 and earned no more.",
    },
    Choice {
        open: "A belief that stands still",
        chosen: "A policy of mean and entropy alone that presses against a limit, where neither \
                 changes any more, would press for ever once its actions are no longer drawn. So \
                 an action that moved nothing and changed no belief is masked until something changes \
                 again, in training, in trials and on the arm; stop never is. The baselines have no \
                 belief and no such mask.",
    },
    Choice {
        open: "What the baselines read",
        chosen: "The newest reading of every channel that would have been counted by the belief \
                 (f_d, f_z, f_n, m_p), forces over the largest mean that the observation model \
                 knows. Not the pose: relative motion is what an LSTM could add up.",
    },
    Choice {
        open: "Recurrent PPO's rollouts",
        chosen: "32 copies of 64 steps, minibatches of eight whole sequences with the states they \
                 began with, an LSTM of its own for the value, PyTorch's initial weights: \
                 sb3-contrib's ways, but for the sizes of rollout and minibatch.",
    },
    Choice {
        open: "The shield",
        chosen: "The paper has none; \"PuBS\" has none in training or trials. \"PuBS with \
                 shield\" has it in both: a policy that learns without one relies on moves near a \
                 limit that the shield then takes away. Before a limit it leaves a margin for what the \
                 handle of an arm may be ahead of the belief: two filter periods of way, and the \
                 give of the grasp. Sim Object is explored under the shield in \
                 either row, and its row \"PuBS\" is judged without.",
    },
    Choice {
        open: "The step of an action, \u{394}s",
        chosen: "The speeds of an object file for one period of the policy, 10 Hz; the reward of \
                 a violation judges the step at the high speed.",
    },
    Choice {
        open: "The moves of Sim Object",
        chosen: "They stand in sim_object.toml. From any start one walks to a limit and jumps \
                 to the goal from there, so the sizes decide the reward: no pair of sizes is \
                 determined by the paper's 0.578.",
    },
    Choice {
        open: "Which reward Table II means for Sim Object",
        chosen: "The discounted one: its 0.575 is that of Table III, which says so.",
    },
    Choice {
        open: "What tells PuBS from SARSOP in Sim Object",
        chosen: "The draw of the starts: PuBS walks to one limit, SARSOP to the other, so that what \
                 is near for one is far for the other. On 100,000 trials of another draw (evaluate \
                 --trials 100000 --seed 101) both earn 0.5831 \u{b1} 0.0006.",
    },
    Choice {
        open: "The definition of Light-Dark",
        chosen: "That of the code behind the paper's [30]: integers from \u{2212}60 to 60, starts \
                 from \u{2212}30 to 30, noise that grows from 0.001 with the distance to 10, \
                 moves of 1 and 10 at a cost of 1 each, +100 for a stop at 0 and \u{2212}100 for \
                 one elsewhere. The variants of the object file are shown beside it.",
    },
    Choice {
        open: "The discount of Light-Dark",
        chosen: "0.99 as for all tasks; [30] has 0.95. Rewards are shown without discount, as the \
                 paper does; the discount decides what solver and training aim at.",
    },
    Choice {
        open: "The reward of a stop in Light-Dark",
        chosen: "The code behind [30] takes no time for the stop; the engine takes it for every \
                 action, so the file has 101 and \u{2212}99.",
    },
    Choice {
        open: "What the solvers observe",
        chosen: "One reading per policy step, the last one, in bins: whole numbers in Light-Dark \
                 (the ends open), the two levels in Sim Object. Their policies are judged on the \
                 same trials of the object as all others, with an exact belief over the bins.",
    },
    Choice {
        open: "What is varied from trial to trial (Table IV)",
        chosen: "The start over the whole range; friction, and catch and seal, by factors from 0.8 \
                 to 1.2; the sensor's noise and the bias that its tare leaves.",
    },
    Choice {
        open: "What the filter takes readings to be off by",
        chosen: "Nothing, as the paper, on door1. On the others each particle also estimates the \
                 sensor's offset and the change of friction (filter = \"rao_blackwell\"): on \
                 door2, whose force is level over most of the range, the tenth of a newton that a \
                 tare leaves looked like another place; in training of the drawers, which run \
                 harder or easier from day to day, a mistaken belief went into the limits.",
    },
    Choice {
        open: "Sensor drift (Table IV)",
        chosen: "An offset that no tare takes away, in a direction of its own for each object, \
                 grows evenly to 2.5 N at the last trial.",
    },
    Choice {
        open: "The cap on steps for the solvers",
        chosen: "250, as for all policies. The paper's row of QMDP (\u{2212}33.2, 13.65 %) suits a \
                 cap near 50: QMDP seldom stops, so that its reward says mostly where it was cut \
                 off.",
    },
    Choice {
        open: "Ten filter updates per large move (Fig. 4, bottom)",
        chosen: "A move of 10 is carried out as that many equal parts, each with an observation \
                 and an update of the weights, at the cost of one step.",
    },
    Choice {
        open: "What a random entropy is (Table III)",
        chosen: "A fresh number from [0, 1] at every policy step, in training and in evaluation \
                 alike.",
    },
    Choice {
        open: "What stands for entropy where it is left out (Table III)",
        chosen: "Nothing: the network has one input less.",
    },
    Choice {
        open: "What a policy on raw observations sees before the first reading",
        chosen: "Zeros.",
    },
    Choice {
        open: "How the best of five seeds is chosen",
        chosen: "By the mean reward on one set of trials; what is shown is reached on a fresh set, \
                 so that the choice does not flatter the number. The paper does not say whether \
                 it made that difference.",
    },
    Choice {
        open: "How many seeds recurrent policies get",
        chosen: "As many as the time allowed; each entry says how many.",
    },
    Choice {
        open: "Which trials count for the time per unit (Table IV)",
        chosen: "The successful ones, as for the goal error: a trial that ends early says nothing \
                 of the time to the goal. Starts at the goal have no distance and are left out.",
    },
];
