# SPDX-License-Identifier: Apache-2.0
"""A trial of rate-aware image latents in PyTorch, to find structures that are worth building.

Trains an autoencoder on the images of a folder until their mean PSNR is what was asked for at the
fewest bits, as a prior tells them that knows the two latents before. Writes the rounded latents;
`latent_bytes` says what they really take. In-sample: it stores what it was trained on.

    engram export STORE 'Vision/RGB/head/cam @ all' --to png -o images
    image_latents.py images --db 35 --seconds 1200 --out latents.bin
    latent_bytes latents.bin

Source: experiments/learning/LOG.md, entry "trials of image latents".
"""
import argparse
import math
import pathlib
import time

import numpy as np
import PIL.Image
import torch
from torch import nn
from torch.nn import functional

GREY_LEVELS = 64.0  # A unit of the networks' image side.
COARSE_STRIDE = 16  # Of the coarse latents; the fine ones have half of it.


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("images", type=pathlib.Path, nargs="+",
                        help="folders of PNG, a recording each, in the order of their names")
    parser.add_argument("--db", type=float, default=35, help="mean PSNR to reach")
    parser.add_argument("--seconds", type=float, default=600, help="of processor time")
    parser.add_argument("--steps", type=int, help="instead of a time")
    parser.add_argument("--width", type=int, default=128, help="features, a multiple of 16")
    parser.add_argument("--coarse", type=int, default=24, help="channels of the coarse latents")
    parser.add_argument("--fine", type=int, default=8, help="channels of the fine latents")
    parser.add_argument("--rate", type=float, default=1.5e-3, help="learning rate")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default="latents.bin")
    return parser.parse_args()


def read_recordings(folders):
    """Images [N, 3, H, W] of all folders, and the number of each one's first."""
    starts, images = [], []
    for folder in folders:
        starts.append(len(images))
        images += [np.asarray(PIL.Image.open(file).convert("RGB"))
                   for file in sorted(folder.rglob("*.png"))]
    if not images:
        raise SystemExit(f"image_latents: no PNG below {', '.join(map(str, folders))}")
    height, width = images[0].shape[:2]
    if any(image.shape != images[0].shape for image in images):
        raise SystemExit("image_latents: images differ in size")
    if height % COARSE_STRIDE or width % COARSE_STRIDE:
        raise SystemExit(f"image_latents: {height} x {width}, needs multiples of {COARSE_STRIDE}")
    return torch.from_numpy(np.stack(images)).permute(0, 3, 1, 2).contiguous(), starts


class Residual(nn.Module):
    """Two convolutions beside an identity; starts as the identity."""

    def __init__(self, features):
        super().__init__()
        self.first = nn.Conv2d(features, features, 3, padding=1)
        self.second = nn.Conv2d(features, features, 3, padding=1)
        nn.init.zeros_(self.second.weight)
        nn.init.zeros_(self.second.bias)

    def forward(self, x):
        return x + self.second(functional.leaky_relu(self.first(x), 0.1))


def active(x):
    return functional.leaky_relu(x, 0.1)


def unshuffled(x, factor):
    return functional.pixel_unshuffle(x, factor).contiguous(memory_format=torch.channels_last)


class Places(nn.Module):
    """What is where: read from a background [B, 3, H, W], and learned by heart of each recording."""

    def __init__(self, width, recordings, height, image_width):
        super().__init__()
        a, b, c, hidden = width, width * 3 // 4, width * 3 // 8, width // 2
        self.stem = nn.Conv2d(48, c, 3, padding=1)
        self.quarter = Residual(c)
        self.to_eighth, self.eighth = nn.Conv2d(4 * c, hidden, 1), Residual(hidden)
        self.out_eighth = nn.Conv2d(hidden, b, 1)
        self.to_sixteenth = nn.Conv2d(4 * hidden, a, 1)
        self.place_16 = nn.Parameter(torch.zeros(recordings, a, height // 16, image_width // 16))
        self.place_8 = nn.Parameter(torch.zeros(1, b, height // 8, image_width // 8))
        self.place_4 = nn.Parameter(torch.zeros(1, c, height // 4, image_width // 4))

    def forward(self, background, recording):
        """Features at strides 16, 8 and 4."""
        quarter = self.quarter(active(self.stem(unshuffled(background, 4))))
        eighth = self.eighth(active(self.to_eighth(unshuffled(quarter, 2))))
        return (self.to_sixteenth(unshuffled(eighth, 2)) + self.place_16[recording],
                self.out_eighth(eighth) + self.place_8, quarter + self.place_4)


class Encoder(nn.Module):
    """Image minus background [B, 3, H, W] -> coarse [B, C, H/16, W/16], fine [B, F, H/8, W/8]."""

    def __init__(self, width, coarse, fine):
        super().__init__()
        a, b, c = width * 3 // 8, width // 2, width * 3 // 4
        self.stem = nn.Conv2d(48, a, 3, padding=1)
        self.quarter = Residual(a)
        self.to_eighth, self.eighth = nn.Conv2d(4 * a, b, 1), Residual(b)
        self.fine = nn.Conv2d(b, fine, 1)
        self.to_sixteenth = nn.Conv2d(4 * b, c, 1)
        self.sixteenth = nn.Sequential(Residual(c), Residual(c))
        self.coarse = nn.Conv2d(c, coarse, 1)

    def forward(self, x, places):
        x = self.quarter(active(self.stem(unshuffled(x, 4)) + places[2]))
        x = self.eighth(self.to_eighth(unshuffled(x, 2)))
        fine = self.fine(x)
        x = self.sixteenth(self.to_sixteenth(unshuffled(x, 2)))
        return self.coarse(x) * 4, fine * 4


class Decoder(nn.Module):
    """Most weights lie where places are few: it may know a scene by heart and stay quick."""

    def __init__(self, width, coarse, fine):
        super().__init__()
        a, b, c, d = width, width * 3 // 4, width * 3 // 8, width * 3 // 16
        self.from_coarse, self.from_fine = (nn.Conv2d(coarse, a, 3, padding=1),
                                            nn.Conv2d(fine, b, 3, padding=1))
        self.blocks_16 = nn.Sequential(Residual(a), Residual(a))
        self.blocks_8 = nn.Sequential(Residual(b), Residual(b))
        self.blocks_4 = nn.Sequential(Residual(c), Residual(c))
        self.block_2 = Residual(d)
        self.to_eighth, self.to_quarter, self.to_half = (
            nn.Conv2d(a, 4 * b, 1), nn.Conv2d(b, 4 * c, 1), nn.Conv2d(c, 4 * d, 1))
        self.out = nn.Conv2d(d, 12, 3, padding=1)
        nn.init.normal_(self.out.weight, 0, 0.02)

    def forward(self, coarse, fine, places):
        def shuffled(x):
            return functional.pixel_shuffle(x, 2)

        x = self.blocks_16(self.from_coarse(coarse) + places[0])
        x = shuffled(self.to_eighth(x)) + self.from_fine(fine)
        x = shuffled(self.to_quarter(self.blocks_8(active(x) + places[1])))
        x = shuffled(self.to_half(self.blocks_4(active(x) + places[2])))
        return shuffled(self.out(self.block_2(active(x))))


class Prior(nn.Module):
    """Mean and log scale of latents, from the two before and what else is known by then."""

    def __init__(self, channels, known=0):
        super().__init__()
        features = 64 if channels > 8 else 32
        self.first = nn.Conv2d(2 * channels + known, features, 3, padding=1)
        self.block = Residual(features)
        self.last = nn.Conv2d(features, 2 * channels, 1)
        nn.init.zeros_(self.last.weight)

    def bits(self, z, last, before, known=None):
        """[B]"""
        x = torch.cat([last, last - before] + ([] if known is None else [known]), 1)
        x = self.last(functional.leaky_relu(self.block(self.first(x)), 0.1))
        mean, log_scale = x.chunk(2, 1)
        return laplace_bits((z - mean).abs(), log_scale.clamp(-4, 6).exp()).sum((1, 2, 3))


def laplace_bits(distance, scale):
    """Of the unit interval around a value so far from the mean."""
    above = 0.5 * torch.exp(-(distance + 0.5) / scale)
    outside = 0.5 * torch.exp(-(distance - 0.5).clamp(min=0) / scale) - above
    inside = 1 - 0.5 * torch.exp(-(0.5 - distance).clamp(min=0) / scale) - above
    return -torch.log2(torch.where(distance > 0.5, outside, inside).clamp(min=1e-7))


class Trial:
    """One training run. Chunks of consecutive images; the first of each is only a past."""

    CHUNKS, CHUNK = 2, 4

    def __init__(self, arguments, images, starts):
        self.arguments, self.images = arguments, images
        self.first = set(starts)
        ends = starts[1:] + [len(images)]
        self.recording = torch.repeat_interleave(
            torch.arange(len(starts)), torch.tensor(ends) - torch.tensor(starts))
        height, width = images.shape[2:]
        coarse, fine = arguments.coarse, arguments.fine
        self.places = Places(arguments.width, len(starts), height, width)
        self.encoder = Encoder(arguments.width, coarse, fine)
        self.decoder = Decoder(arguments.width, coarse, fine)
        self.prior, self.fine_prior = Prior(coarse), Prior(fine, coarse)
        networks = [self.places, self.encoder, self.decoder, self.prior, self.fine_prior]
        self.weights = [p for network in networks for p in network.parameters()]
        for network in networks:
            network.to(memory_format=torch.channels_last)
        medians = [images[self.recording == r].float().median(0).values
                   for r in range(len(starts))]
        self.background = nn.Parameter(torch.stack(medians) / GREY_LEVELS)
        self.optimiser = torch.optim.Adam(
            [{"params": self.weights}, {"params": [self.background]}], betas=(0.9, 0.98))
        self.log_weight = math.log(0.01)  # Of distortion against rate: follows the PSNR.

    def draw(self):
        chunks = []
        while len(chunks) < self.CHUNKS:
            start = np.random.randint(0, len(self.images) - self.CHUNK)
            if not any(start + i in self.first for i in range(1, self.CHUNK + 1)):
                chunks.append(list(range(start, start + self.CHUNK + 1)))
        return torch.tensor(chunks)

    def look(self, recording):
        """What is known of recordings before an image of them is: looked up once for each."""
        background = self.background[recording].contiguous(memory_format=torch.channels_last)
        return [background, *self.places(background, recording)]

    def encode(self, numbers, view):
        x = self.images[numbers].float() / GREY_LEVELS
        plain = (x - view[0]).contiguous(memory_format=torch.channels_last)
        return x, self.encoder(plain, view[1:])

    def bits(self, coarse, fine):
        """Of rows 1.. of [chunks, rows, ...]: each tensor's last two rows are its past."""

        def past(z):
            before = torch.cat([z[:, :1], z[:, :-2]], 1)
            return z[:, 1:].flatten(0, 1), z[:, :-1].flatten(0, 1), before.flatten(0, 1)

        now = past(coarse)
        known = functional.interpolate(now[0], scale_factor=2)
        return self.prior.bits(*now) + self.fine_prior.bits(*past(fine), known)

    def step(self, share):
        rate = self.arguments.rate * min(1, share / 0.02 + 0.02)
        rate *= 0.005 + 0.995 * 0.5 * (1 + math.cos(math.pi * share))
        self.optimiser.param_groups[0]["lr"] = rate
        self.optimiser.param_groups[1]["lr"] = rate / 2
        numbers = self.draw()
        view = self.look(self.recording[numbers[:, 0]])
        x, latents = self.encode(numbers.flatten(),
                                 [part.repeat_interleave(self.CHUNK + 1, 0) for part in view])
        # Noise stands in for rounding, later gradients pass straight through it.
        rounded = [z + torch.rand_like(z) - 0.5 if share < 0.5 else z + (z.round() - z).detach()
                   for z in latents]
        coarse, fine = [z.view(self.CHUNKS, self.CHUNK + 1, *z.shape[1:]) for z in rounded]
        bits = self.bits(coarse, fine)
        view = [part.repeat_interleave(self.CHUNK, 0) for part in view]
        decoded = self.decoder(coarse[:, 1:].flatten(0, 1), fine[:, 1:].flatten(0, 1), view[1:])
        wanted = x.view(self.CHUNKS, self.CHUNK + 1, *x.shape[1:])[:, 1:].flatten(0, 1)
        error = (decoded + view[0] - wanted).square().mean((1, 2, 3))
        error = error * GREY_LEVELS ** 2
        loss = error.mean() * math.exp(self.log_weight) + bits.mean() / 8000
        self.optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.weights, 1.0)
        self.optimiser.step()
        psnr = (10 * torch.log10(255 ** 2 / (error.detach() + 1e-3))).mean().item()
        return psnr, bits.mean().item() / 8

    def run(self):
        begin, report, steps, psnr, bytes_each = time.process_time(), 60, 0, None, 0.0
        max_steps = self.arguments.steps
        while True:
            spent = time.process_time() - begin
            share = steps / max_steps if max_steps else spent / self.arguments.seconds
            if share >= 1:
                break
            now, now_bytes = self.step(share)
            psnr = now if psnr is None else 0.98 * psnr + 0.02 * now
            bytes_each = 0.98 * bytes_each + 0.02 * now_bytes
            if share > 0.05:
                self.log_weight += 0.003 * float(np.clip(self.arguments.db - psnr, -1, 1))
                self.log_weight = float(np.clip(self.log_weight, math.log(1e-4), 0))
            steps += 1
            if spent > report:
                report += 60
                images = steps * self.CHUNKS * self.CHUNK / spent
                print(f"{spent:5.0f} s  {images:.0f} images/s  {psnr:.2f} dB  {bytes_each:.0f} B",
                      flush=True)
        print(f"{steps * self.CHUNKS * self.CHUNK / spent:.1f} images per second of processor time")

    @torch.no_grad()
    def measure(self):
        """PSNR of every image from its rounded latents, and these: [N, latents]."""
        psnr, rows = [], []
        for numbers in torch.arange(len(self.images)).split(16):
            view = self.look(self.recording[numbers])
            _, (coarse, fine) = self.encode(numbers, view)
            coarse, fine = coarse.round(), fine.round()
            decoded = self.decoder(coarse, fine, view[1:]) + view[0]
            error = (decoded * GREY_LEVELS).clamp(0, 255).round() - self.images[numbers].float()
            mse = error.square().mean((1, 2, 3)).clamp(min=255 ** 2 / 1e6)
            psnr.append(10 * torch.log10(255 ** 2 / mse))
            rows.append(torch.cat([coarse.flatten(1), fine.flatten(1)], 1).int())
        return torch.cat(psnr), torch.cat(rows)


def main():
    arguments = parse_arguments()
    torch.set_num_threads(1)
    torch.manual_seed(arguments.seed)
    np.random.seed(arguments.seed)
    images, starts = read_recordings(arguments.images)
    trial = Trial(arguments, images, starts)
    trial.run()
    psnr, rows = trial.measure()
    size = sum(p.numel() for p in trial.decoder.parameters()) + trial.background.numel()
    print(f"{len(images)} images: {psnr.mean():.2f} dB mean over images, minimum {psnr.min():.2f}; "
          f"decoder and backgrounds {size:,} weights")
    height, width = images.shape[2] // 16, images.shape[3] // 16
    grids = [arguments.coarse, height, width, arguments.fine, 2 * height, 2 * width]
    header = [len(images), len(starts), *starts, *grids]
    np.concatenate([np.array(header, np.int32), rows.numpy().ravel()]).tofile(arguments.out)
    print(f"{arguments.out}: the latents")


if __name__ == "__main__":
    main()
