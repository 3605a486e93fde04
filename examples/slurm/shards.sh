#!/bin/bash
# One sweep over many machines: a job array computes the shards, a job that waits for all of them puts them together:
#   array=$(sbatch --parsable --array=1-8 examples/slurm/shards.sh sweeps/dahl_alpha.toml output/dahl_alpha)
#   sbatch --dependency=afterok:$array examples/slurm/merge.sh output/dahl_alpha
# A task that failed is submitted again as it is, with the number of shards as third argument: --array=3 … output/dahl_alpha 8
#SBATCH --job-name=pbif-shards
#SBATCH --cpus-per-task=2
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=TERM@60
set -uo pipefail
file=${1:?which sweep file?}
out=${2:?which folder for the run?}
shards=${3:-$SLURM_ARRAY_TASK_COUNT}

# Every shard has a folder of its own below $out/shards, so tasks never wait for each other.
srun pbif sweep "$file" --shard "$SLURM_ARRAY_TASK_ID/$shards" --out "$out" --resume --threads "$SLURM_CPUS_PER_TASK"
status=$?

# 130: interrupted, because the time is up or the node is wanted. The same task is queued again and goes on.
if [ "$status" -eq 130 ]; then
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$status"
