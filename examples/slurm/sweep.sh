#!/bin/bash
# One sweep on a cluster, which goes on where it was when the job is preempted, runs out of time or its node fails:
#   sbatch examples/slurm/sweep.sh sweeps/dahl_alpha.toml
#SBATCH --job-name=pbif
#SBATCH --cpus-per-task=4
#SBATCH --time=04:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=TERM@120
set -uo pipefail
file=${1:?which sweep file?}
name=$(basename "$file" .toml)

# --resume begins where nothing is, goes on where something is, and prints the results of what is complete. Slurm's TERM, two minutes before the
# end, lets pbif write tables and figures of the points that are done.
srun pbif sweep "$file" --out "output/$name" --resume --threads "$SLURM_CPUS_PER_TASK"
status=$?

# 130: interrupted. The same job is queued again and goes on.
if [ "$status" -eq 130 ]; then
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$status"
