#!/bin/bash
# Many sweeps as a job array, one a noise intensity, each in a folder of its own and each able to go on:
#   sbatch --array=0-4 examples/slurm/array.sh sweeps/coulomb_fc.toml
# A task that failed or ran out of time is submitted again as it is: --array=3
#SBATCH --job-name=pbif-array
#SBATCH --cpus-per-task=2
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=TERM@60
set -uo pipefail
file=${1:?which sweep file?}
intensities=(0.005 0.0075 0.01 0.015 0.02)
sigma2=${intensities[$SLURM_ARRAY_TASK_ID]}

exec srun pbif sweep "$file" --set "system.parameters.sigma2=$sigma2" --out "output/$(basename "$file" .toml)-$sigma2" \
  --resume --threads "$SLURM_CPUS_PER_TASK"
