# SPDX-License-Identifier: Apache-2.0
# Everything from a bare Debian 12: `make demo` shows it, `make test` proves it.

# Where the demo looks for recordings: pairs NAME.mp4 and NAME.csv in any folder below.
# Empty, or a folder that is missing: a simulated kitchen.
RECORDINGS ?= ../shared/data
# Time that the demo trains, the length of a simulated recording, and the build that it shows.
DEMO_BUDGET ?= 150s
DEMO_SECONDS ?= 60
DEMO_PRESET ?= release
# Options of the kitchen of make robot.
KITCHEN ?=
# Options of the measurements of the store, such as BARS="--seconds 5".
BARS ?=
# Options of bench-build.
BENCH ?=
# How long each fuzzer searches, and the soak lasts.
SECONDS ?= 600
# How many processes `make crash` and `make crash-night` kill.
KILLS ?= $(if $(filter crash-night,$(MAKECMDGOALS)),100,$(if $(filter skill-kills,$(MAKECMDGOALS)),1000,300))
# Which part of the experiments' config.json, and more options.
PAPER ?= full
PAPER_OPTIONS ?=
# More options of month.
MONTH_OPTIONS ?=
# How long ask-bars trains what answers by attention, if it is not there.
ANSWERS_BUDGET ?= 60m
# What training-speed trains on.
VIDEO ?= $(RECORDINGS)/clips/bottle-detection.mp4
DB ?= 35
BUDGET ?= 1200

.PHONY: help packages build test demo robot robot-demo view bench bench-build crash crash-night faults soak server-cut skill-kills skill-bars drives fuzz \
        check-headers check-locks clean reference experiments recorder-bars store-scale store-readers store-peers number-bars prediction-bars forecast-bars member-bars codec-bars night-codec-bars \
        import-bars latent-trial training-speed learning-bars night-bars day-bars short-nights group-bars month hostile many-bars recall-bars fade-bars ninety-days reflection-bars replay-bars age-bars saliency-bars ask-bars notice-bars sight-bars viewer-bars live-bars sensory-bars paper storage loocv transfer

help:
	@echo "make demo    record, compress, train, recall and predict, with measured figures"
	@echo "             (RECORDINGS=dir, DEMO_BUDGET=150s, DEMO_SECONDS=60, DEMO_PRESET=release)"
	@echo "make robot   a live robot in a kitchen, its memory and the page that shows it, until Ctrl-C (KITCHEN=options)"
	@echo "make view    the demo's memory in the browser, until Ctrl-C (DEMO_PRESET=release)"
	@echo "make test    build with debug information and run all tests"
	@echo "make check-headers   compile every public header alone"
	@echo "make check-locks     is what a mutex guards used with it held? (clang 14)"
	@echo "make build   release build: build/release/bin/engram"
	@echo "make bench   run the benchmarks"
	@echo "make robot-demo      'Bring me the salt': a live robot plans, drives, is stopped, and is asked why"
	@echo "make drives  drive a simulated robot 500 times among moving chairs and persons"
	@echo "make bench-build     processor time of a fresh release build, per room and of the dearest sources"
	@echo "             (BENCH=--json, or BENCH='--report build/release' for a build that is there)"
	@echo "make crash   kill recording processes at random moments, look for what they stored (KILLS=300)"
	@echo "make crash-night     kill nightly jobs and fading at random moments, look for what they lost (KILLS=100)"
	@echo "make faults  let every file operation of a session fail, cut the power after each"
	@echo "make many-bars   100,000 entities, answers of any size: time, disk and RAM (BARS=options)"
	@echo "make hostile attack stores and the programs that open them, on this machine (BARS=options)"
	@echo "make soak    kill servers, clients and the name system at random moments (SECONDS=600)"
	@echo "make skill-kills     kill providers of skills and their server: one start, one end each (KILLS=1000)"
	@echo "make server-cut      cut a server off the network: how soon do clients go on? (needs root)"
	@echo "make recorder-bars   does the recorder keep up with a robot? (RECORDINGS, BARS=options)"
	@echo "make store-scale     does a store of ten million snapshots stay quick?"
	@echo "make store-readers   do readers in several threads get in each other's way?"
	@echo "make store-peers     the same stream in ROS bags, HDF5 and SQLite"
	@echo "make number-bars     what joint positions cost within an error bound (RECORDINGS)"
	@echo "make learning-bars   what learning reaches on recordings, hours (RECORDINGS, BARS=options)"
	@echo "make night-bars      what a night costs an image at three sizes, and a day, hours (RECORDINGS, BARS=options)"
	@echo "make day-bars        consolidate a day of two cameras whole, hours (RECORDINGS, BARS='--budget 1h')"
	@echo "make short-nights    how nights end that are shorter than a day needs, or longer (RECORDINGS, BARS=options)"
	@echo "make group-bars      what stored videos take, beside libaom without random access (RECORDINGS, BARS=options)"
	@echo "make month   30 nights of two stores: do they stay small, quick and true? up to 3 hours"
	@echo "             (MONTH_OPTIONS='--form short': 11 small nights, minutes; it goes on where it was)"
	@echo "make fade-bars       what remains of images that fade, and for how many bytes (RECORDINGS, BARS=options)"
	@echo "make ninety-days     what a store answers of 90 simulated days with a tenth of its bytes (BARS=options)"
	@echo "make recall-bars     how often likeness finds the same phase of a task elsewhere (BARS=options)"
	@echo "make saliency-bars   what a tenth of the snapshots of kitchens still answers (RECORDINGS, BARS=options)"
	@echo "make reflection-bars 200 faults in kitchens: how many are found, and false alarms (BARS=options)"
	@echo "make replay-bars is a replay the memory that it was: bytes, leaks, order, seeks (BARS=options)"
	@echo "make ask-bars    2,000 questions each of seven kinds about 40 kitchens: answered rightly, refused, how"
	@echo "             soon; first it trains what reads questions (ANSWERS_BUDGET=60m, BARS=options)"
	@echo "make notice-bars how rightly grasps are found in joints; ten questions about a real robot (RECORDINGS)"
	@echo "make sight-bars  what is where and in which colour, told from latents of images alone (BARS=options)"
	@echo "make viewer-bars how quick the viewer is, in a browser (BARS='--scale STORE')"
	@echo "make live-bars   how quickly the viewer shows what a robot commits, and its memory (BARS='--seconds 3600')"
	@echo "make prediction-bars how well joints are predicted from their past (RECORDINGS)"
	@echo "make member-bars     how well members of values are predicted (DB=store BARS=options)"
	@echo "make skill-bars      how soon a skill starts after the event that it waits for (BARS=options)"
	@echo "make age-bars        how much older data grow on their way through a memory server (BARS=options)"
	@echo "make sensory-bars    what cameras cost that nobody attends to, and what attention finds (BARS=options)"
	@echo "make codec-bars      what video codecs need for what quality (RECORDINGS, BARS=options)"
	@echo "make night-codec-bars    bytes and time where every image keeps a bound (RECORDINGS, BARS)"
	@echo "make import-bars     how fast videos come in, beside FFmpeg (RECORDINGS, BARS=options)"
	@echo "make latent-trial    a structure of image latents on IMAGES=folders (DB=35 BUDGET=1200)"
	@echo "make training-speed  images per second that training takes, beside PyTorch (VIDEO=file)"
	@echo "make reference       docs/reference from the program and the package, the C++ API as HTML"
	@echo "make paper   the paper's tables and figures on RECORDINGS: build/paper/full/paper.html"
	@echo "             (PAPER=short: minutes, not hours; PAPER_OPTIONS=--help; also make storage, loocv, transfer)"
	@echo "make fuzz    search for inputs that break a parser (SECONDS=600 each)"
	@echo "make clean   remove what was built and the demo's memory"

packages:
	@cmake/install_packages.sh

build/%/build.ninja: CMakeLists.txt CMakePresets.json | packages
	cmake --preset $*

build: build/release/build.ninja packages
	cmake --build --preset release

test: build/dev/build.ninja packages
	cmake --build --preset dev
	ctest --preset dev

demo: build/$(DEMO_PRESET)/build.ninja packages
	cmake --build --preset $(DEMO_PRESET) --target engram
	experiments/demo.sh build/$(DEMO_PRESET)/bin/engram demo "$(RECORDINGS)" $(DEMO_BUDGET) $(DEMO_SECONDS)

# The demo has made the memory and built the program.
view:
	build/$(DEMO_PRESET)/bin/engram view demo/robot.engram

# A robot that lives, until Ctrl-C: options of its kitchen, such as KITCHEN="--fast --chair 1.0,0.2".
robot: build/$(DEMO_PRESET)/build.ninja packages
	cmake --build --preset $(DEMO_PRESET) --target engram
	experiments/robot.sh build/$(DEMO_PRESET)/bin/engram demo/robot docs/robot.yaml $(KITCHEN)

bench: build
	cmake --preset release -DENGRAM_BENCHMARKS=ON
	cmake --build --preset release --target engram_benchmark engram_paper_objects \
	  engram_recording_speed engram_neighbour_index
	build/release/bin/engram_paper_objects
	build/release/bin/engram_benchmark
	build/release/bin/engram_neighbour_index

# "Bring me the salt": skills, navigation and conditions on a live robot, without a display.
robot-demo: build/$(DEMO_PRESET)/build.ninja packages
	cmake --build --preset $(DEMO_PRESET) --target engram engram_python
	PYTHONPATH=build/$(DEMO_PRESET)/python /usr/bin/python3 -B experiments/robot_demo.py build/$(DEMO_PRESET)/bin/engram demo/bring $(BARS)

# A simulated robot among chairs that are pushed and persons who walk about: what came of 500 drives,
# and how soon a map follows an object.
DRIVES = 500
drives: build
	cmake --preset release -DENGRAM_BENCHMARKS=ON
	cmake --build --preset release --target engram_navigation_speed engram_navigation_drives
	rm -rf build/drives && mkdir build/drives
	build/release/bin/engram_navigation_speed build/drives
	build/release/bin/engram_navigation_drives build/drives/robot.engram $(DRIVES) 1

# A fresh release build without ccache, in build/bench; BENCH=--help.
bench-build: packages
	/usr/bin/python3 -B tests/benchmark/build_time.py $(BENCH)

crash: build/dev/build.ninja packages
	cmake --build --preset dev --target crash
	experiments/crash.sh $(KILLS)

crash-night: build/dev/build.ninja packages
	cmake --build --preset dev --target crash_night
	build/dev/bin/crash_night $(KILLS)

faults: build/dev/build.ninja packages
	cmake --build --preset dev --target faults_test
	TMPDIR=$$(test -d /dev/shm && echo /dev/shm || echo /tmp) ENGRAM_FAULTS_ALL=1 build/dev/bin/faults_test

soak: build/dev/build.ninja packages
	cmake --build --preset dev --target soak_server
	experiments/soak.sh $(SECONDS)

skill-kills: build/dev/build.ninja packages
	cmake --build --preset dev --target skill_kills
	build/dev/bin/skill_kills $(KILLS)

server-cut: build/dev/build.ninja packages
	cmake --build --preset dev --target server_cut
	experiments/server_cut.sh build/dev/bin/server_cut

# Measurements of the store, docs/store_bars.md: a project of its own that uses what is installed.
experiments: build/store/build.ninja packages
	cmake --build --preset store
	cmake --install build/store --prefix build/store/installed > build/store/install.log
	cmake --install build/store --prefix build/store/installed --component internals >> build/store/install.log
	cmake -S experiments -B build/experiments -G Ninja -DCMAKE_BUILD_TYPE=Release \
	  -DCMAKE_PREFIX_PATH="$(CURDIR)/build/store/installed"
	cmake --build build/experiments

# Its stream: pairs NAME.mp4 and NAME.csv below RECORDINGS, else the videos alone, else a scene.
MEASURE = cd build/experiments && \
  ENGRAM_RECORDINGS="$(if $(wildcard $(RECORDINGS)),$(abspath $(RECORDINGS)))"

recorder-bars: experiments
	$(MEASURE) store/recorder_bars --json recorder_bars.json $(BARS)

store-scale: experiments
	$(MEASURE) store/store_scale --json store_scale.json $(BARS)

store-readers: experiments
	$(MEASURE) store/store_readers --json store_readers.json $(BARS)

# DB is a store, such as one of engram simulate kitchen.
member-bars: experiments
	$(MEASURE) learning/member_bars "$(abspath $(DB))" --json member_bars.json $(BARS)

number-bars: experiments
	$(MEASURE) learning/number_bars --json number_bars.json $(BARS)

prediction-bars: experiments
	$(MEASURE) learning/prediction_bars --json prediction_bars.json $(BARS)

# The old name, until version 0.3.
forecast-bars: prediction-bars

codec-bars: experiments
	$(MEASURE) learning/codec_bars --json codec_bars.json $(BARS)

night-codec-bars: experiments
	$(MEASURE) learning/night_codec_bars --json night_codec_bars.json $(BARS)

skill-bars: experiments
	$(MEASURE) server/skill_bars --json skill_bars.json $(BARS)

age-bars: experiments
	$(MEASURE) server/age_bars --json age_bars.json $(BARS)

sensory-bars: experiments
	$(MEASURE) server/sensory_bars --json sensory_bars.json $(BARS)

import-bars: build
	experiments/datasets/import_bars.py build/release/bin/engram \
	  "$(RECORDINGS)/clips/one-by-one-person-detection.mp4" $(BARS)

learning-bars: build
	experiments/learning/learning_bars.py build/release/bin/engram "$(RECORDINGS)" build/learning_bars \
	  $(BARS)

# Options: experiments/learning/night_bars.py --help
night-bars: build
	experiments/learning/night_bars.py build/release/bin/engram \
	  "$(if $(wildcard $(RECORDINGS)),$(abspath $(RECORDINGS)))" --json build/night_bars.json $(BARS)

# Options: experiments/learning/day_bars.py --help
day-bars: build
	@cmake/install_packages.sh experiments/packages.txt
	experiments/learning/day_bars.py build/release/bin/engram "$(abspath $(RECORDINGS))" \
	  --work build/day --json build/day_bars.json $(BARS)

# Options: experiments/learning/short_nights.py --help
short-nights: build
	experiments/learning/short_nights.py build/release/bin/engram \
	  "$(if $(wildcard $(RECORDINGS)),$(abspath $(RECORDINGS)))" --json build/short_nights.json $(BARS)

# Options: experiments/learning/group_bars.py --help
group-bars: build
	@cmake/install_packages.sh experiments/packages.txt
	experiments/learning/group_bars.py build/release/bin/engram "$(abspath $(RECORDINGS))" \
	  --json build/group_bars.json $(BARS)

# Options: /usr/bin/python3 -m experiments.month --help
month: build
	PYTHONPATH="$(CURDIR):$(CURDIR)/build/release/python" PYTHONDONTWRITEBYTECODE=1 \
	  /usr/bin/python3 -m experiments.month $(MONTH_OPTIONS)

# Options: /usr/bin/python3 -m experiments.hostile --help
hostile: build
	PYTHONPATH="$(CURDIR):$(CURDIR)/build/release/python" PYTHONDONTWRITEBYTECODE=1 \
	  /usr/bin/python3 -m experiments.hostile $(BARS)

# Options: /usr/bin/python3 -m experiments.many --help
# Options: /usr/bin/python3 -m experiments.recall --help
recall-bars: build
	@cmake/install_packages.sh experiments/packages.txt
	PYTHONPATH="$(CURDIR):$(CURDIR)/build/release/python" PYTHONDONTWRITEBYTECODE=1 \
	  /usr/bin/python3 -m experiments.recall --recordings "$(RECORDINGS)/g1" $(BARS)
	PYTHONPATH="$(CURDIR):$(CURDIR)/build/release/python" PYTHONDONTWRITEBYTECODE=1 \
	  /usr/bin/python3 -m experiments.recall.places

many-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -m experiments.many --engram build/release/bin/engram \
	  $(BARS)

fade-bars: build
	experiments/learning/fade_bars.py build/release/bin/engram "$(abspath $(RECORDINGS))" $(BARS)

# Options: experiments/replay/replay_bars.py --help
replay-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/replay/replay_bars.py \
	  build/release/bin/engram build/release/python --json build/replay_bars.json $(BARS)

# Options: experiments/reflection/reflection_bars.py --help
reflection-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/reflection/reflection_bars.py \
	  build/release/bin/engram build/release/python --json build/reflection_bars.json $(BARS)

# Options: experiments/ask/ask_bars.py --help
ask-bars: experiments build build/ask/answers.attention
	@echo "== rules, the generator's own words"
	$(ASK_BARS) --route program $(HOSTILE) --json build/ask_bars_rules.json $(BARS)
	@echo "== network, the same"
	$(ASK_BARS) --route attention $(NETWORK) --bar 80 --json build/ask_bars_network.json $(BARS)
	@echo "== rules and network, the same"
	$(ASK_BARS) $(NETWORK) $(HOSTILE) --json build/ask_bars.json $(BARS)
	@echo "== rules, words of others"
	$(ASK_BARS) --route program $(FOREIGN) --json build/ask_bars_foreign_rules.json $(BARS)
	@echo "== rules and network, words of others"
	$(ASK_BARS) $(NETWORK) $(FOREIGN) --json build/ask_bars_foreign.json $(BARS)
	@echo "== rules, wordings that come with Engram and were held out"
	$(ASK_BARS) --route program --written --split held-out --bar 85 \
	  --json build/ask_bars_written_rules.json $(BARS)
	@echo "== rules and network, the same"
	$(ASK_BARS) $(NETWORK) --written --split held-out --bar 85 \
	  --json build/ask_bars_written.json $(BARS)
	@echo "== rules and network, 30 days in one store"
	$(ASK_BARS) $(NETWORK) --days 30 --questions 300 --json build/ask_bars_days.json $(BARS)
NETWORK = --attention build/ask/answers.attention
HOSTILE = --hostile experiments/ask/hostile.jsonl
FOREIGN = --phrasings experiments/ask/foreign_questions.jsonl --bar 85
ASK_BARS = PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/ask/ask_bars.py \
  build/release/bin/engram build/experiments/ask/engram_make_dialogues
# What reads questions by attention, of 20 kitchens that are asked nothing later: an hour on a core.
build/ask/answers.attention: | build
	build/release/bin/engram simulate kitchen --folder build/ask/learned --no-images --colours \
	  --jobs 2 --seed 101..120
	build/release/bin/engram learn-answers build/ask/learned/*.engram --out $@ \
	  --budget $(ANSWERS_BUDGET)

# Options: experiments/ask/notice_bars.py --help
notice-bars: build
	build/release/bin/engram simulate kitchen --folder build/notice/kitchens --no-images --jobs 2 \
	  --seed 201..220
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/ask/notice_bars.py \
	  build/release/bin/engram --kitchens build/notice/kitchens \
	  --recording "$(RECORDINGS)/g1" --work build/notice --json build/notice_bars.json $(BARS)

# Options: experiments/ask/sight_bars.py --help
sight-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/ask/sight_bars.py \
	  build/release/bin/engram --work build/sights --json build/sight_bars.json $(BARS)

# Options: experiments/viewer/viewer_bars.py --help
viewer-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/viewer/viewer_bars.py \
	  build/release/bin/engram build/release/viewer/web --json build/viewer_bars.json $(BARS)

# Options: experiments/viewer/live_bars.py --help
live-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/viewer/live_bars.py \
	  build/release/bin/engram build/release/viewer/web --json build/live_bars.json $(BARS)

# Options: experiments/saliency/saliency_bars.py --help
saliency-bars: build
	PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 experiments/saliency/saliency_bars.py \
	  build/release/bin/engram build/release/python --recordings "$(RECORDINGS)/g1" \
	  --json build/saliency_bars.json $(BARS)

# Options: experiments/forgetting/ninety_days.py --help
ninety-days: build
	experiments/forgetting/ninety_days.py build/release/bin/engram --json build/ninety_days.json $(BARS)

# Measured results are kept in build/paper, and used again for as long as nothing changed.
paper storage loocv transfer: build
	@$(MAKE) experiments
	PYTHONPATH="$(CURDIR):$(CURDIR)/build/release/python" PYTHONDONTWRITEBYTECODE=1 \
	  /usr/bin/python3 -m experiments.$@ --recordings "$(RECORDINGS)" --profile $(PAPER) $(PAPER_OPTIONS)

training-speed: build
	@cmake/install_packages.sh experiments/packages.txt
	experiments/learning/training_speed.sh build/release/bin/engram $(VIDEO)

latent-trial:
	@cmake/install_packages.sh experiments/packages.txt
	@$(MAKE) experiments
	/usr/bin/python3 experiments/learning/image_latents.py $(IMAGES) --db $(DB) --seconds $(BUDGET) \
	  --out build/experiments/latents.bin
	build/experiments/learning/latent_bytes build/experiments/latents.bin

store-peers:
	@cmake/install_packages.sh experiments/packages.txt
	@$(MAKE) experiments
	$(MEASURE) store/store_peers --json store_peers.json $(BARS)

# What is found new stays in build/fuzz/found; an input that breaks a parser is named and kept.
fuzz: packages
	@cmake/install_packages.sh tests/packages.txt
	cmake --preset fuzz
	cmake --build --preset fuzz
	@set -e; for corpus in tests/fuzz/corpus/*; do \
	  name=$$(basename $$corpus); mkdir -p build/fuzz/found/$$name; \
	  build/fuzz/bin/$${name}_fuzz -max_total_time=$(SECONDS) -timeout=10 -rss_limit_mb=2048 \
	    -artifact_prefix=build/fuzz/found/$$name- build/fuzz/found/$$name $$corpus; done

# What is generated of the documentation: two pages that are kept, and build/reference/html.
reference: build
	docs/generate_command_reference.py build/release/bin/engram
	docs/generate_python_reference.py
	mkdir -p build/reference
	doxygen docs/Doxyfile
	@echo build/reference/html/index.html

# Every header that a room declares compiles alone.
check-headers: build/dev/build.ninja packages
	cmake --build --preset dev --target all_verify_interface_header_sets

# What is generated of messages has to be there: sources include it.
check-locks: build/dev/build.ninja packages
	@cmake/install_packages.sh tests/packages.txt
	cmake --build --preset dev --target engram_protocol
	tests/architecture/check_locks.py --build build/dev

clean:
	rm -rf build demo
