#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What learning has to reach on recordings, measured with the program alone, one core each.

Prints one line per bar: what it got, what it needs, and whether it does. A bar that was measured
is read from WORK/results.json; --again measures it anew. All of it takes some three hours.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))

# Clip: quality to reach, what to ask for, minutes, most bytes an image, other options, bound and
# minutes of `auto`.
CLIPS = {
    "bottle": (44.0, 44.6, 20, 90, [], 44, 8),
    "one": (38.0, 38.2, 30, 150, [], 40, 14),
    "g1": (35.0, 35.4, 20, 300, ["--varied", "0"], 38, 12),
}
# Episodes of g1 that all figures are compared on. The passes of motion and the gain that latents
# need were chosen on them, too, so the last episodes, which nothing was chosen on, are measured
# beside.
REPORTED = 5
NEVER_CHOSEN_ON = 6
# Rivals have no least quality of their own: they are measured at the one that is to be reached.
FIRST_CRF, CRF_STEP = 34, 6
VIDEOS = {"bottle": "bottle-detection.mp4", "one": "one-by-one-person-detection.mp4"}
NIGHTS = 1000
ACCESS_MS = (4, 25)
IMAGES_PER_SECOND = 50
LEFT_OUT = {"min_db": 30.0, "max_bytes": 383, "max_gap_db": 1.5, "gains_db": (1.0, 1.5)}


class Bars:
    def __init__(self, engram, recordings, work, again):
        self.engram, self.recordings, self.work = engram, pathlib.Path(recordings), work
        self.results_file = work / "results.json"
        known = json.loads(self.results_file.read_text()) if self.results_file.exists() else {}
        self.results = {name: value for name, value in known.items() if name not in again}
        self.failed = 0

    def run(self, *arguments):
        """Progress stays on stderr."""
        words = [str(self.engram), *map(str, arguments)]
        print("$ engram " + " ".join(words[1:]), file=sys.stderr)
        return subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout

    def measured(self, name, measure):
        if name not in self.results:
            self.results[name] = measure()
            self.results_file.write_text(json.dumps(self.results, indent=1))
        return self.results[name]

    def verdict(self, name, got, needed, is_reached):
        self.failed += not is_reached
        print(f"{name:<16} {'reached' if is_reached else 'MISSED':<8} {got}  (needs {needed})")
        sys.stdout.flush()

    def video(self, name):
        found = sorted(self.recordings.rglob(name))
        if not found:
            sys.exit(f"recordings: no {name} below {self.recordings}")
        return found[0]

    def store(self, clip, rate=("--rate", "5"), episodes=REPORTED):
        """The clip as recorded, 128 x 128. `episodes`: so many of g1, None for all."""
        more = "" if episodes == REPORTED else "-episodes"
        path = self.work / f"{clip}{'' if rate[0] == '--rate' else '-all'}{more}.engram"
        if path.exists():
            return path
        new = path.with_suffix(".new")
        shutil.rmtree(new, ignore_errors=True)
        usual = ["--entity", CAMERA, "--size", "128x128", *rate]
        if clip in VIDEOS:
            self.run("import", "--video", self.video(VIDEOS[clip]), "--crop-square", *usual,
                     "--start", "2022-02-18T13:00Z", new)
        else:
            videos = sorted(self.recordings.rglob("*cam_high/*.mp4"))[:episodes]
            if len(videos) < 2:
                sys.exit(f"recordings: {len(videos)} of cam_high below {self.recordings}, needs 2")
            for minute, video in enumerate(videos):
                self.run("import", "--video", video, "--table", self.video(video.stem + ".csv"),
                         "--state-entity", JOINTS, "--skip-column", "frame_index", *usual,
                         "--start", f"2022-02-18T13:{minute:02d}Z", new)
        new.rename(path)
        return path

    def consolidated(self, source, target, *options):
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(source, target)
        report = json.loads(self.run("consolidate", target, "--entity", CAMERA, "--width", 128,
                                     "--threads", 1, "--json", *options))
        return report["entities"][0]

    def latents(self, clip):
        min_db, asked, minutes, max_bytes, options, _, _ = CLIPS[clip]
        target = self.work / f"{clip}-latents.engram"
        found = self.measured(f"latents:{clip}", lambda: self.consolidated(
            self.store(clip), target, "--representation", "latents", "--psnr", asked,
            "--training", f"{minutes}m", *options))
        images = found["images"]
        each = images["kept_bytes"] / images["rows"]
        model = found["model_bytes"]
        psnr = found["psnr_mean_over_images_db"]
        self.verdict(f"latents:{clip}", f"{each:.0f} B an image at {psnr:.2f} dB mean over images; "
                     f"with the model {each + model / images['rows']:.0f} for {images['rows']}, "
                     f"{each + model / 3000:.0f} for 3,000, {each + model / 30000:.0f} for 30,000; "
                     f"{self.rivals_text(clip)}", f"at most {max_bytes} B at {min_db} dB",
                     each <= max_bytes and psnr >= min_db)

    def images(self, clip):
        """All images of a clip [N, H, W, 3], by the package beside the program."""
        import numpy as np

        sys.path.insert(0, str(self.engram.resolve().parents[1] / "python"))
        import engram

        with engram.open(self.store(clip)) as memory:
            return np.stack([one.image for one in memory[CAMERA].snapshots()])

    def rival(self, clip, coder):
        """Points around the quality to reach, one key frame: crf, bytes an image and PSNR, mean
        over images."""
        from experiments.paper import video_coders

        images = self.images(clip)
        points, needed, crf = [], CLIPS[clip][0], FIRST_CRF
        while 0 <= crf <= 51:
            points.append(video_coders.point(images, coder, crf, 0, 5))
            psnrs = [point["psnr_db"] for point in points]
            if min(psnrs) < needed <= max(psnrs):
                break
            crf += CRF_STEP if psnrs[-1] >= needed else -CRF_STEP
        return points

    def rivals(self, clip):
        """AV1 and H.265 as they are beside latents: bytes where the mean of PSNR is just enough."""
        from experiments.paper import quality, video_coders

        found = {}
        for coder in video_coders.coders("best")[1:]:
            points = self.measured(f"rivals:{clip}:{coder.title}",
                                   lambda coder=coder: self.rival(clip, coder))
            found[coder.title] = quality.bytes_at(
                [(point["bytes"], point["psnr_db"]) for point in points], CLIPS[clip][0])
        return found

    def rivals_text(self, clip):
        return ", ".join(f"{title.split(' ')[0]} {size:.0f}"
                         for title, size in self.rivals(clip).items())

    def beside(self, clip):
        print(f"{'beside:' + clip:<16} {'':<8} {self.rivals_text(clip)} B an image at "
              f"{CLIPS[clip][0]} dB mean over images, one key frame", flush=True)

    def auto(self, clip):
        _, _, _, _, options, bound, minutes = CLIPS[clip]
        trained = self.work / f"{clip}-latents.engram"
        found = self.measured(f"auto:{clip}", lambda: self.consolidated(
            trained if trained.exists() else self.store(clip), self.work / f"{clip}-auto.engram",
            "--representation", "auto", "--nights", NIGHTS, "--psnr", bound, "--force",
            "--training", f"{minutes}m", *options))
        images = found["images"]
        model = found["model_bytes"] / NIGHTS
        alone = {"latents": images["latent_bytes"] + model if not images["below_bound_rows"] else 0,
                 "latents with residuals": images["residual_bytes"] and
                                           images["residual_bytes"] + model,
                 "video": images["video_bytes"], "without loss": images["lossless_bytes"]}
        alone = {name: size for name, size in alone.items() if size > 0}
        best = min(alone, key=alone.get)
        without = images["video_kept_bytes"] + images["lossless_kept_bytes"]
        has_networks = images["kept_bytes"] > without
        kept = images["kept_bytes"] + (model if has_networks else 0)
        rows, minimum = images["rows"], found["psnr_minimum_db"]
        self.verdict(f"auto:{clip}", f"{kept / rows:.1f} B an image and night of {NIGHTS} with the "
                     f"model, lowest {minimum:.2f} dB; best alone {best} {alone[best] / rows:.1f}",
                     f"at most 1 % above, {bound} dB",
                     kept <= 1.01 * alone[best] and minimum >= bound)

    def left_out(self):
        def measure():
            return json.loads(self.run(
                "crossval", self.store("g1", ("--all",)), "--entity", CAMERA, "--spacing", "200ms",
                "--training", "12m", "--psnr", 31.2, "--bound", 30.1, "--varied", 0.9, "--width", 96,
                "--threads", 1, "--json"))

        report = self.measured("left-out", measure)
        for fold in [*report["folds"], report["all"]]:
            one = fold["variants"]["rate"]
            gains, corrected = one["gain_over_copy_last_db"], one["corrected"]
            psnr, each = corrected["left_out"]["mean_psnr_db"], corrected["left_out_bytes"]
            gap = corrected["reconstruction_gap_db"]
            copied = fold["baselines"]["copy-last"]
            pooled = [ahead["pooled_psnr_db"] - copy["pooled_psnr_db"]
                      for ahead, copy in zip(one["prediction"], copied)]
            is_all = "left_out_from" not in fold
            needed = LEFT_OUT["gains_db"] if is_all else (0, 0)
            is_good = all(gain >= needs for gain, needs in zip(gains, needed))
            if is_all:
                is_good &= (psnr >= LEFT_OUT["min_db"] and each <= LEFT_OUT["max_bytes"] and
                            gap <= LEFT_OUT["max_gap_db"])
            bounds = [bound["images"] for bound in one["bound"][:2]]
            within = [f"{100 * bound['share']:.0f} %, {bound['mean_width_db']:.1f} dB wide"
                      for bound in bounds]
            self.verdict("left-out:" + ("all" if is_all else fold["left_out_from"][11:16]),
                         f"{psnr:.2f} dB at {each:.0f} B, {gap:.2f} dB below those trained on; "
                         f"over copying next {gains[0]:+.2f} mean, {pooled[0]:+.2f} dB pooled, "
                         f"over-next {gains[1]:+.2f}, {pooled[1]:+.2f}; 90 % bounds hold for "
                         f"{'; '.join(within)}",
                         "30 dB at 383 B, 1.5 dB apart, +1.0 and +1.5" if is_all
                         else "above copying",
                         is_good)

    def never_chosen_on(self):
        """Prediction of recordings that nothing was trained on and no constant was chosen on."""
        def measure():
            source = self.store("g1", episodes=None)
            target = self.work / "never-chosen-on.engram"
            self.consolidated(source, target, "--hold-out", NEVER_CHOSEN_ON, "--representation",
                              "latents", "--psnr", 31, "--training", "10m", "--varied", 0.9)
            return json.loads(self.run("eval", target, "--entity", CAMERA, "--json"))

        entity = self.measured("never-chosen-on", measure)["entities"][0]
        for one in entity["prediction"]["left-out recordings"]:
            model, copied, bound = one["model"], one["copy_last"], one["model_bound"]["images"]
            gain = model["mean_psnr_db"] - copied["mean_psnr_db"]
            pooled = model["pooled_psnr_db"] - copied["pooled_psnr_db"]
            self.verdict(f"unseen:{one['horizon']} ahead",
                         f"{model['images']} images, {model['mean_psnr_db']:.2f} dB mean over "
                         f"images, {gain:+.2f} over copying, {pooled:+.2f} pooled; 90 % bounds "
                         f"hold for {100 * bound['share']:.1f} %, {bound['mean_width_db']:.2f} dB "
                         "wide",
                         "above copying", gain > 0)

    def access(self):
        store = self.work / "g1-latents.engram"
        if not store.exists():
            self.latents("g1")
        report = self.measured("access", lambda: json.loads(self.run(
            "eval", store, "--entity", CAMERA, "--json")))
        entity = report["entities"][0]
        in_order, scattered = entity["in_order_ms"], entity["scattered_ms"]
        self.verdict("access", f"{in_order:.1f} ms in order (mean), {scattered:.1f} ms scattered (median)",
                     f"{ACCESS_MS[0]} and {ACCESS_MS[1]} ms, coding is conditional",
                     in_order <= ACCESS_MS[0] and scattered <= ACCESS_MS[1])

    def speed(self):
        found = self.measured("speed", lambda: self.consolidated(
            self.store("bottle"), self.work / "speed.engram", "--representation", "latents",
            "--steps", 200))
        speed = found["images_per_processor_second"]
        self.verdict("speed", f"trains on {speed:.1f} images a second of processor time",
                     f"{IMAGES_PER_SECOND}; beside PyTorch: make training-speed",
                     speed >= IMAGES_PER_SECOND)


def main():
    bars = [f"{what}:{clip}" for clip in CLIPS for what in ("latents", "auto")]
    bars += [f"beside:{clip}" for clip in CLIPS]
    bars += ["left-out", "never-chosen-on", "access", "speed"]
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path)
    parser.add_argument("recordings", help="folder with the clips, anywhere below")
    parser.add_argument("work", type=pathlib.Path, help="folder for stores and results")
    parser.add_argument("--only", nargs="+", choices=bars, default=bars, metavar="BAR",
                        help=", ".join(bars))
    parser.add_argument("--again", action="store_true", help="measure them anew")
    arguments = parser.parse_args()
    if not arguments.engram.exists():
        sys.exit(f"{arguments.engram}: no such program")
    arguments.work.mkdir(parents=True, exist_ok=True)
    run = Bars(arguments.engram, arguments.recordings, arguments.work,
               arguments.only if arguments.again else [])
    for bar in arguments.only:
        what, _, clip = bar.partition(":")
        measure = getattr(run, what.replace("-", "_"))
        try:
            measure(clip) if clip else measure()
        except subprocess.CalledProcessError as error:
            sys.exit(f"{bar}: engram {error.cmd[1]} ended with {error.returncode}")
    sys.exit(1 if run.failed else 0)


if __name__ == "__main__":
    main()
