#!/bin/bash
# Puts the shards of a sweep together, see shards.sh. It says which are missing, and goes on where it was stopped.
#SBATCH --job-name=pbif-merge
#SBATCH --cpus-per-task=4
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=TERM@60
set -uo pipefail
out=${1:?which folder holds the run?}

srun pbif merge "$out" --threads "$SLURM_CPUS_PER_TASK"
status=$?
if [ "$status" -eq 130 ]; then
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$status"
