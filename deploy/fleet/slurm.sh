#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
#
# One shard of a sweep per task of a Slurm array, with neoeti-tools installed on the nodes:
#   sbatch --array=0-31 deploy/fleet/slurm.sh stability --out /shared/results
# The arguments are eti-bench's. When all tasks have ended: eti-bench merge DIR /shared/results/shard-*-of-32
#
#SBATCH --job-name=neoeti
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --mem=2G
#SBATCH --output=neoeti-%A-%a.log
set -euo pipefail

: "${SLURM_ARRAY_TASK_ID:?is not set: start this with sbatch --array=0-N}"
: "${SLURM_ARRAY_TASK_COUNT:?is not set: start this with sbatch --array=0-N}"
if [ "${SLURM_ARRAY_TASK_MIN:-0}" -ne 0 ] || [ "${SLURM_ARRAY_TASK_STEP:-1}" -ne 1 ]; then
    echo "slurm.sh: shards are numbered consecutively from 0: --array=0-$((SLURM_ARRAY_TASK_COUNT - 1))" >&2
    exit 2
fi
exec "${ETI_BENCH:-eti-bench}" --threads "${SLURM_CPUS_PER_TASK:-1}" "$@" \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
