#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# Regenerates the figures of docs/ and README: measures, draws, and copies them to where the pages show them.
set -u
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
export LANGUAGE=en  # of texts in pictures

PARTS=(accuracy calibration matter stability sufficiency sleep cost view presets study score haptics grid bus soak anatomy pictures render
       readers panel first_session report)
# Duration of each on two cores.
declare -A TAKES=([accuracy]="three minutes" [calibration]="two minutes" [matter]="twelve minutes" [stability]="three minutes"
                  [sufficiency]="seven minutes" [sleep]="three minutes" [cost]="three minutes" [view]="two minutes" [presets]="ten minutes" [study]="half an hour"
                  [score]="half an hour" [haptics]="ten minutes" [grid]="ten minutes" [bus]="an hour and three quarters" [soak]="three hours"
                  [anatomy]="a minute" [pictures]="a minute" [render]="five minutes" [readers]="five minutes" [panel]="a minute"
                  [first_session]="two minutes" [report]="two minutes")
# What carries a stamp with its physics version, cheapest first; the others are pictures, or measure programs and network.
STAMPED=(calibration view cost sleep stability readers render haptics accuracy presets matter sufficiency study score)
INDEPENDENT=(grid bus soak)
# What docs/tables.py writes into pages.
TABLED=(accuracy cost view readers matter sufficiency render presets study score)
PICTURES=(laryngoscope section overview)
LESSONS=(lesson_2 lesson_3 lesson_4 lesson_5 final)
CHARTS=$ETI_ROOT/docs/charts
OUT=$ETI_ROOT/out/figures

usage() {
    cat <<USAGE
Usage: deploy/figures.sh [--quick | --stale] [--only NAME]... [--demo DIR] [--no-build] [--no-install] [--list]
Repeats the measurements shown in docs/ and draws them. What depends on the physics takes two hours on two cores;
network and endurance take five hours more, and need no repetition when the physics changes. A part's tables replace those
of docs/charts once its measurement has succeeded; until then they are in out/figures. Sessions of studies stay there, by
physics version: they are run once.
  --quick       measure nothing: draw all charts again from the tables of docs/charts
  --stale       only the parts whose tables belong to another physics version, cheapest first: lists them, then
                measures them again. With --list: only lists them
  --only NAME   this part; may be repeated:
$(for part in "${PARTS[@]}"; do printf '                  %-12s %s\n' "$part" "${TAKES[$part]}"; done)
  --demo DIR    for pictures: use those in this demo's folder (out/demo/demo-...) instead of running one,
                also with --quick
  --no-build    use build/release as it is
  --no-install  do not look for missing packages
  --list        list the output files without writing them
  --help        print this
Matter, sufficiency, sleep, cost, view, presets, study, score, bus and soak have tables and no figure. Pictures are README's,
anatomy the slices of segmented heads, render the views against their goals, readers what a lab's own program reads and its cost, panel the instructor's beside
a session, first_session the steps of an intubation with mouse and keys, report the page about two recorded sessions.
USAGE
}

quick=no stale=no build=yes install=yes list=no demo='' only=()
while [ $# -gt 0 ]; do
    case $1 in
        --quick) quick=yes ;;
        --stale) stale=yes ;;
        --only)
            [ $# -ge 2 ] && [ -n "${TAKES[$2]:-}" ] || eti_fail "--only expects one of: ${PARTS[*]}"
            only+=("$2")
            shift
            ;;
        --demo)
            [ $# -ge 2 ] || eti_fail "--demo expects a demo's folder; see --help"
            demo=$2
            shift
            ;;
        --no-build) build=no ;;
        --no-install) install=no ;;
        --list) list=yes ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done
[ $quick = no ] || [ $stale = no ] || eti_fail "--quick measures nothing, so it cannot refresh stale tables: omit one of the two"
if [ ${#only[@]} -eq 0 ]; then
    [ $stale = yes ] && only=("${STAMPED[@]}") || only=("${PARTS[@]}")
fi

stamps() { "$ETI_PYTHON" -B "$ETI_ROOT/docs/stamps.py" --server "$ETI_ROOT/build/release/bin/eti-server" "$@"; }
plot() { "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/plot.py" "$CHARTS" "$@"; }
draws() { case $1 in accuracy | calibration | stability | haptics) true ;; *) false ;; esac; }

# bench PART ARGUMENT...: runs a command of eti-bench with a folder of its own, and copies its tables to docs/charts.
bench() {
    local folder=$OUT/$1
    shift
    mkdir -p "$folder" "$CHARTS" && rm -f "$folder"/*.csv
    "$ETI_ROOT/build/release/bin/eti-bench" "$@" --out "$folder" && cp "$folder"/*.csv "$CHARTS"
}

# Whether a word is among others: among WORD OTHER...
among() {
    local other
    for other in "${@:2}"; do [ "$other" = "$1" ] && return 0; done
    return 1
}

# Waits for processes; whether all of them succeeded.
all_succeed() {
    local one failed=0
    for one in "$@"; do wait "$one" || failed=1; done
    return $failed
}

# halves PART ARGUMENT...: the same, as two processes that share the runs.
halves() {
    local folder=$OUT/$1 share running=()
    shift
    rm -rf "$folder" && mkdir -p "$folder"
    for share in 0 1; do
        "$ETI_ROOT/build/release/bin/eti-bench" --threads 1 "$@" --out "$folder" --shard "$share/2" &
        running+=($!)
    done
    all_succeed "${running[@]}" && "$ETI_ROOT/build/release/bin/eti-bench" merge "$folder/merged" "$folder"/shard-* &&
        cp "$folder"/merged/*.csv "$CHARTS"
}

# The lift of both newborns at once; blocks are measured with the first.
matter() {
    local folder=$OUT/matter first bench="$ETI_ROOT/build/release/bin/eti-bench"
    rm -rf "$folder" && mkdir -p "$folder"
    "$bench" --threads 1 matter --scenario term --out "$folder/term" &
    first=$!
    "$bench" --threads 1 matter --scenario premature --no-blocks --out "$folder/premature" || { wait $first; return 1; }
    wait $first && cp "$folder/term/matter-blocks.csv" "$CHARTS" &&
        { cat "$folder/term/matter.csv"; tail -n +2 "$folder/premature/matter.csv"; } >"$CHARTS/matter.csv"
}

# sessions STUDY: its sessions in a folder of this physics version, which an interrupted run continues. Two processes share
# them. Prints the folder.
sessions() {
    local folder=$OUT/$1-$(stamps --version) running=() one
    [ "$folder" != "$OUT/$1-" ] || return 1
    for one in 1 2; do
        "$ETI_ROOT/build/release/bin/eti-review" study "$1" --out "$folder" --threads 1 >&2 &
        running+=($!)
    done
    all_succeed "${running[@]}" && echo "$folder"
}

cost() {
    mkdir -p "$OUT" && "$ETI_ROOT/build/release/bin/eti-bench" speed --json >"$OUT/cost.json" && cp "$OUT/cost.json" "$CHARTS"
}

view() {
    mkdir -p "$OUT" && "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/view_over_lift.py" --out "$OUT/view-over-lift.csv" >&2 &&
        cp "$OUT/view-over-lift.csv" "$CHARTS"
}

presets() {
    mkdir -p "$OUT" || return 1
    "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/presets.py" "$ETI_ROOT/build/release/bin" --jobs 2 >"$OUT/presets.csv" &&
        cp "$OUT/presets.csv" "$CHARTS"
}

# The study of the paper's conditions: by condition, and experts beside novices.
study() {
    local folder review=$ETI_ROOT/build/release/bin/eti-review expert novice pick='$6 == "\"" who "\"" { gsub(/["\r]/, "", $10); print $10 }'
    folder=$(sessions conditions) || return 1
    cd "$folder" || return 1
    rm -f sessions.csv
    mapfile -t expert < <(awk -F, -v who=expert "$pick" plan.csv)
    mapfile -t novice < <(awk -F, -v who=novice "$pick" plan.csv)
    "$review" compare --group term term/*.h5 --group premature premature/*.h5 --paired --expect conditions --csv sessions.csv \
        --json >conditions.json &&
        "$review" compare --group expert "${expert[@]}" --group novice "${novice[@]}" --json >operators.json &&
        cp sessions.csv "$CHARTS/study-sessions.csv" && cp conditions.json "$CHARTS/study-conditions.json" &&
        cp operators.json "$CHARTS/study-operators.json"
}

# Trains the shipped score, and applies it to the shipped scripts.
score() {
    local folder bin=$ETI_ROOT/build/release/bin
    folder=$(sessions graded) || return 1
    rm -f "$folder/scripted.yaml" "$folder/judged.html"
    "$bin/eti-review" score train "$folder"/*/*.h5 --name scripted --out "$folder/scripted.yaml" --html "$folder/judged.html" >&2 &&
        cp "$folder/scripted.yaml" "$ETI_ROOT/deploy/data/scores/scripted.yaml" &&
        ETI_BIN=$bin "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/score_scripts.py" >"$OUT/score-scripts.csv" &&
        cp "$OUT/score-scripts.csv" "$CHARTS"
}

# Slices of two segmented heads, as eti-anatomy draws them beside the labels.
anatomy() {
    local tool=$ETI_ROOT/build/release/bin/eti-anatomy folder=$OUT/anatomy pages=$ETI_ROOT/docs/anatomy
    mkdir -p "$folder" "$pages"
    "$tool" phantom --weight-kg 3.5 --out "$folder/newborn.nrrd" >&2 &&
        "$tool" segment "$folder/newborn.nrrd" --out "$folder/phantom.nrrd" >&2 &&
        "$tool" segment /usr/share/doc/invesalius-examples/examples/Cranium.inv3 --out "$folder/cranium.nrrd" >&2 &&
        cp "$folder/phantom.png" "$folder/cranium.png" "$pages"
}

# README's figures: one moment of a demo, at the best view of the glottis.
pictures() {
    local folder=$demo view found
    if [ -z "$folder" ]; then
        rm -rf "$OUT/demo"
        "$ETI_PYTHON" -B "$ETI_ROOT/deploy/session_run.py" --bin "$ETI_ROOT/build/release/bin" --out "$OUT/demo" >&2 || return 1
        folder=$(echo "$OUT"/demo/demo-*)
    fi
    for view in "${PICTURES[@]}"; do
        found=("$folder"/observer/"${view}"_best_*.png)
        [ -f "${found[0]}" ] || { eti_say "There is no ${view}_best_*.png in $folder/observer; pass a demo's folder."; return 1; }
    done
    for view in "${PICTURES[@]}"; do
        cp "$folder"/observer/"${view}"_best_*.png "$ETI_ROOT/docs/pictures/$view.png" || return 1
    done
}

# Views at moments of attempts, against goals, and a contact sheet.
render() {
    local folder=$OUT/render
    rm -rf "$folder"
    "$ETI_ROOT/build/release/bin/eti-bench" render --scenario term --scenario premature --operator expert \
        --out "$folder" && cp "$folder/render-goals.csv" "$CHARTS" &&
        cp "$folder/term_expert.png" "$ETI_ROOT/docs/pictures/rendering.png"
}

# Output of a lab's reader while the blade lifts the tongue, and the cost of reading for the server.
readers() {
    local folder=$OUT/readers bin=$ETI_ROOT/build/release/bin place=(--session figures --domain 96) server read
    mkdir -p "$folder" && "$ETI_ROOT/deploy/examples/build.sh" "$folder" >&2 || return 1
    "$bin/eti-server" --scenario term --operator expert "${place[@]}" >&2 &
    server=$!
    "$folder/surface_reader" "${place[@]}" --out "$folder" --seconds 7 >&2
    read=$?
    kill -INT $server && wait $server
    [ $read = 0 ] && "$ETI_PYTHON" -B "$ETI_ROOT/deploy/examples/draw_state.py" "$folder" "$ETI_ROOT/docs/pictures/lab_readers.png" &&
        "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/lab_readers.py" --examples "$folder" >"$folder/lab-readers.csv" &&
        cp "$folder/lab-readers.csv" "$CHARTS"
}

# The instructor's panel beside an expert's attempt, in a window.
panel() {
    local bin=$ETI_ROOT/build/release/bin place=(--session figures --domain 96) server taken
    "$bin/eti-server" --scenario term_enhanced --operator expert "${place[@]}" >&2 &
    server=$!
    "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/window_picture.py" --seconds 8 "$ETI_ROOT/docs/pictures/panel.png" \
        "$bin/eti-client" --panel --size 1280x720 "${place[@]}" >&2
    taken=$?
    kill -INT $server && wait $server
    [ $taken = 0 ]
}

# An intubation with mouse and keys, following the tutorial: a picture at the start of each lesson, and of the end.
first_session() {
    local folder=$OUT/first_session bin=$ETI_ROOT/build/release/bin place=(--session figures --domain 95) server lesson
    rm -rf "$folder" && mkdir -p "$folder"
    "$bin/eti-server" --scenario term --finish-after-attempt "${place[@]}" >&2 &
    server=$!
    XDG_CONFIG_HOME=$folder "$bin/eti-client" --offscreen "$folder" --no-video --every 0 --hands --tutorial on \
        --play "$ETI_ROOT/deploy/data/hands/term.yaml" --wait 60 "${place[@]}" >&2 || { kill -INT $server; return 1; }
    wait $server
    for lesson in "${LESSONS[@]}"; do
        cp "$folder"/*_"$lesson"_0*.png "$ETI_ROOT/docs/pictures/first_session_$lesson.png" || return 1
    done
}

# The page about an expert's session beside a novice's, in a browser that draws in software.
report() {
    local folder=$OUT/report bin=$ETI_ROOT/build/release/bin operator
    rm -rf "$folder" && mkdir -p "$folder"
    for operator in expert novice; do
        "$bin/eti-server" --scenario term --operator "$operator" --fast --no-dds --record "$folder/$operator.eti.h5" >&2 || return 1
    done
    "$bin/eti-review" report "$folder"/{novice,expert}.eti.h5 --out "$folder" >&2 &&
        chromium --headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
            --hide-scrollbars --window-size=1200,1960 --virtual-time-budget=20000 --user-data-dir="$folder/profile" \
            --screenshot="$ETI_ROOT/docs/pictures/report.png" "file://$folder/report.html" >&2
}

# A server whose operator repeats its script: an hour in real time, then eight simulated hours.
soak() {
    local run=("$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/server/soak.py" --out "$OUT/soak")
    "${run[@]}" --hours 1 >&2 && "${run[@]}" --fast --hours 8 >&2 && cp "$OUT"/soak/soak-{real,fast}.csv "$CHARTS"
}

measure() {
    case $1 in
        # Costs are compared, so these run alone.
        accuracy | calibration | sleep) bench "$1" --threads 1 "$1" ;;
        stability) halves "$1" "$1" ;;
        sufficiency) halves "$1" "$1" --scenario term --scenario premature ;;
        haptics) for one in stability gaps rendered laws live; do bench "$1" "$1" --only $one || return 1; done ;;
        grid) bench haptics haptics --only grid --whole-grid && plot --only haptics ;;
        bus) bench "$1" "$1" --soak 60 ;;
        soak) soak ;;
        matter | cost | view | presets | study | score | anatomy | pictures | render | readers | panel | first_session | report) "$1" ;;
    esac
}

name_stale() {
    local found
    found=$(stamps --stale "${only[@]}") || eti_fail "the physics version is unknown; see above"
    mapfile -t only < <(printf '%s' "$found" | sed '/^$/d')
    for part in "${only[@]}"; do printf '%-12s %s\n' "$part" "${TAKES[$part]}"; done
}

if [ $stale = yes ] && [ $list = yes ]; then
    name_stale
    exit 0
fi
if [ $list = yes ]; then
    for part in "${only[@]}"; do
        if draws "$part"; then plot --only "$part" --list; fi
        case $part in
            anatomy) printf '%s\n' "$ETI_ROOT"/docs/anatomy/{phantom,cranium}.png ;;
            pictures) printf "$ETI_ROOT/docs/pictures/%s.png\n" "${PICTURES[@]}" ;;
            render) printf '%s\n' "$ETI_ROOT/docs/pictures/rendering.png" ;;
            first_session) printf "$ETI_ROOT/docs/pictures/first_session_%s.png\n" "${LESSONS[@]}" ;;
            readers) printf '%s\n' "$ETI_ROOT/docs/pictures/lab_readers.png" ;;
            panel) printf '%s\n' "$ETI_ROOT/docs/pictures/panel.png" ;;
            report) printf '%s\n' "$ETI_ROOT/docs/pictures/report.png" ;;
        esac
    done | sed "s|^$ETI_ROOT/||"
    exit 0
fi

lists=(build client test figures)
[ $quick = yes ] && lists=(figures)
[ $install = yes ] && eti_install "${lists[@]}"
if [ $quick = no ] && [ $build = yes ]; then
    eti_say "Building build/release ..."
    eti_build release -DETI_TESTS=ON || exit 1
fi
if [ $stale = yes ]; then
    name_stale
    [ ${#only[@]} -gt 0 ] || { eti_say "Every table belongs to the current physics version."; exit 0; }
fi
failed=()
for number in "${!only[@]}"; do
    part=${only[$number]}
    if [ $quick = no ] || { [ "$part" = pictures ] && [ -n "$demo" ]; }; then
        eti_say "== $((number + 1)) of ${#only[@]}: $part, measuring (${TAKES[$part]})"
        (measure "$part") || { failed+=("$part"); eti_say "$part failed; its tables in docs/ are unchanged."; continue; }
        if among "$part" "${STAMPED[@]}"; then
            stamps --record "$part" "deploy/figures.sh --only $part" || failed+=("$part")
        elif among "$part" "${INDEPENDENT[@]}"; then
            stamps --independent --record "$part" "deploy/figures.sh --only $part" || failed+=("$part")
        fi
        if among "$part" "${TABLED[@]}"; then
            "$ETI_PYTHON" -B "$ETI_ROOT/docs/tables.py" >&2 || failed+=("$part")
        fi
    fi
    if draws "$part"; then
        eti_say "== $((number + 1)) of ${#only[@]}: $part, drawing"
        plot --only "$part" || failed+=("$part")
    fi
    # What the pages say of these tables, where they were measured just now.
    if [ $quick = no ] && grep -q "^class ${part^}(" "$ETI_ROOT/tests/bench/check_tables.py"; then
        "$ETI_PYTHON" -B "$ETI_ROOT/tests/bench/check_tables.py" "${part^}" >&2 ||
            { failed+=("$part"); eti_say "$part: the pages contradict the new tables; see above, and correct the pages."; }
    fi
done
[ ${#failed[@]} -eq 0 ] || eti_fail "failed: ${failed[*]}"
eti_say "Done. See what changed: git diff --stat docs"
