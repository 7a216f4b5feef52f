"""Trains the network: train.py DATA OUT [--size standard|small|albedo] [--minutes M | --steps N] [--shared-noise] [--device cpu|cuda] [--batch N] [--seed N]

Goes on from OUT/checkpoint.pt if that is there. Writes OUT/checkpoint.pt, OUT/best.pt (the averaged weights with the least
error on the shots held out) and OUT/curve.csv (minutes, step, training error, held-out error, energy,
held-out error of merged frames, as a share of theirs).
"""

import argparse
import copy
import functools
import math
import os
import sys
import time

import numpy as np
import torch

import batches
import device_batches
import export
import idle_channels
import losses
from network import CHANNELS, Network, parameter_count

LAST_RATE = 0.02  # of the learning rate
WARM_UP = 200
AVERAGE_DECAY = 0.999
EVALUATE_EVERY_MIN = 5.0


def share_of_rate(share, step):
    """Of the learning rate, after `share` of the time: cosine, after a linear start."""
    cosine = LAST_RATE + (1.0 - LAST_RATE) * 0.5 * (1.0 + math.cos(math.pi * min(share, 1.0)))
    return min(1.0, (step + 1) / WARM_UP) * cosine


@torch.no_grad()
def held_out_error(network, pairs):
    """Geometric mean over pairs of relMSE as a share of the noisy frames', and the median change of energy."""
    device = next(network.parameters()).device
    logs, energies = [], []
    for pair in pairs:
        frame = [t.to(device) for t in batches.whole_frame(pair)]
        result, _ = losses.smoothed(network, frame)
        references = frame[3]
        noisy = losses.rel_mse(frame[0][:, :3], references)
        logs.append(math.log(max(losses.rel_mse(result, references), 1e-6) / max(noisy, 1e-6)))
        energies.append((result.mean() / references.mean()).item() - 1.0)
    return math.exp(np.mean(logs)), float(np.median(energies))


class Trainer:
    def __init__(self, args):
        self.args = args
        os.makedirs(args.out, exist_ok=True)
        torch.manual_seed(args.seed)
        network = export.read_weights(args.start) if args.start else Network(CHANNELS[args.size])
        self.albedo = args.size == "albedo"
        if self.albedo and not args.start:
            network.start_from_identity()
        self.least = losses.LEAST_OF_ALBEDO if self.albedo else losses.LEAST_RELATIVE
        self.network = network.to(args.device, memory_format=torch.channels_last)
        self.average = copy.deepcopy(self.network)
        self.optimizer = torch.optim.Adam(self.network.parameters(), args.rate, eps=1e-8)
        self.step, self.spent_s, self.best = 0, 0.0, math.inf
        self.chosen_on = []  # names of the pairs of which `best` is the error
        if os.path.exists(self.path("checkpoint.pt")):
            self.resume()

    def path(self, name):
        return os.path.join(self.args.out, name)

    def resume(self):
        state = torch.load(self.path("checkpoint.pt"), map_location=self.args.device)
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.step, self.spent_s, self.best = state["step"], state["spent_s"], state["best"]
        self.chosen_on = state.get("chosen_on", [])

    def share_done(self):
        """Of the steps, if there is a number of them, else of the time."""
        return self.step / self.args.steps if self.args.steps > 0 else self.spent_s / (60.0 * self.args.minutes)

    def save(self):
        state = {
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "step": self.step,
            "spent_s": self.spent_s,
            "best": self.best,
            "chosen_on": self.chosen_on,
            "channels": self.network.channels,
        }
        self.save_whole(state, "checkpoint.pt")

    def save_whole(self, state, name):
        torch.save(state, self.path(name + ".partial"))
        os.replace(self.path(name + ".partial"), self.path(name))

    def numbers_of_step(self):
        """Random numbers of the seed and the step, so that a training that goes on does not draw those of its start again."""
        return torch.Generator().manual_seed(int(np.random.SeedSequence([self.args.seed, self.step]).generate_state(1)[0]))

    def train_step(self, batch):
        for group in self.optimizer.param_groups:
            group["lr"] = self.args.rate * share_of_rate(self.share_done(), self.step)
        batch = [t.to(self.args.device) for t in batch]
        scales = losses.random_scales(len(batch[0]), self.numbers_of_step()).to(self.args.device)
        loss, relative = losses.training_loss(*losses.smoothed(self.network, batch), batch[3], scales, self.least)
        self.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self.optimizer.step()
        decay = min(AVERAGE_DECAY, (self.step + 1) / (self.step + 10))
        with torch.no_grad():
            for mean, now in zip(self.average.parameters(), self.network.parameters()):
                mean.lerp_(now, 1.0 - decay)
        self.step += 1
        return relative.item()

    def evaluate(self, pairs, training_error):
        error, energy = held_out_error(self.average, pairs) if pairs else (math.nan, math.nan)
        merged = [pair for pair in pairs if pair.merged]
        of_merged, _ = held_out_error(self.average, merged) if merged else (math.nan, math.nan)
        line = f"{self.spent_s / 60:.2f},{self.step},{training_error:.5f},{error:.5f},{energy:.5f},{of_merged:.5f}"
        print(line, flush=True)
        with open(self.path("curve.csv"), "a") as file:
            file.write(line + "\n")
        if pairs and not math.isfinite(error):
            raise SystemExit(f"train: step {self.step}: the held-out error is {error}; best.pt and the checkpoint stay as they were")
        if not pairs or error < self.best:
            self.best = error
            self.save_whole({"network": self.average.state_dict(), "channels": self.network.channels}, "best.pt")
        self.save()

    def choose_on(self, pairs):
        """Measures what was best so far anew where other shots were held out."""
        names = [pair.name for pair in pairs]
        if self.chosen_on != names and math.isfinite(self.best) and pairs:
            best = copy.deepcopy(self.average)
            best.load_state_dict(torch.load(self.path("best.pt"), map_location=self.args.device)["network"])
            self.best, _ = held_out_error(best, pairs)
        self.chosen_on = names

    def stream(self, pairs):
        asked = pairs, self.args.batch, self.args.crop, [self.args.seed, self.step], self.args.workers
        if self.args.device == "cpu" or self.albedo:
            return batches.stream(*asked, functools.partial(batches.crop, shared=self.args.shared_noise))
        return device_batches.stream(*asked, self.args.device, self.args.shared_noise)

    def run(self):
        learn, choose = batches.load(self.args.data, self.args.renderer, self.albedo, self.args.shared_noise)
        if self.args.albedo:
            batches.smooth_albedos(learn + choose, export.read_weights(self.args.albedo))
        print(f"{len(learn)} pairs to learn from, {len(choose)} to choose on, {parameter_count(self.network)} parameters")
        if self.args.start and self.step == 0:
            print(f"{idle_channels.restart(self.network, choose)} channels were zero on all held-out frames")
            self.average = copy.deepcopy(self.network)
        self.choose_on(choose)
        stream = self.stream(learn)
        last_evaluation = time.monotonic()
        errors = []
        while self.share_done() < 1.0:
            start = time.monotonic()
            errors.append(self.train_step(next(stream)))
            now = time.monotonic()
            self.spent_s += now - start
            if now - last_evaluation > 60.0 * EVALUATE_EVERY_MIN:
                self.evaluate(choose, float(np.mean(errors)))
                errors = []
                last_evaluation = time.monotonic()
        self.evaluate(choose, float(np.mean(errors)) if errors else math.nan)


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("data")
    parser.add_argument("out")
    parser.add_argument("--size", choices=sorted(CHANNELS), default="standard", help="albedo: the one that smooths albedo, and learns from it")
    parser.add_argument("--start", metavar="FILE.weights", help="begin with these weights; their size counts, channels that are zero start anew")
    parser.add_argument("--albedo", metavar="FILE.weights", help="smooth the frames' albedos by this network first")
    parser.add_argument("--renderer", choices=("becalm", "cycles"), default="", help="learn from its shots alone")
    parser.add_argument("--shared-noise", action="store_true", help="learn from frames whose neighbouring pixels share noise as well")
    parser.add_argument("--minutes", type=float, default=240.0)
    parser.add_argument("--steps", type=int, default=0, help="so many steps instead")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--batch", type=int, default=6, help="crops a step")
    parser.add_argument("--rate", type=float, default=1e-3, help="the learning rate")
    parser.add_argument("--workers", type=int, default=0, help="processes that make batches beside the one that learns")
    parser.add_argument("--crop", type=int, default=batches.CROP)
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args(words)


def main():
    args = parse(sys.argv[1:])
    torch.set_num_threads(args.threads)
    torch.backends.cudnn.benchmark = True  # all batches are of one size
    Trainer(args).run()


if __name__ == "__main__":
    main()
