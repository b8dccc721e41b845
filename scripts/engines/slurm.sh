#!/bin/sh
# The tasks of a plan as a Slurm job array. The folder of the plan must lie on a disk that all nodes see.
#
#     tokosen plan contours.gpkg -i 2 --cell 5 --memory 4G -o plan
#     tokosen work plan --list > open.txt
#     sbatch --array=1-"$(wc -l < open.txt)" --export=ALL,PLAN=plan,OPEN=open.txt slurm.sh
#     tokosen join plan -o dense.gpkg --dem dem.tif        # when all jobs have ended
#
# If jobs were lost, make open.txt again and submit it once more: tasks that are done are not done again.
#SBATCH --job-name=tokosen
#SBATCH --cpus-per-task=1
#SBATCH --mem=4500M
#SBATCH --time=02:00:00
set -eu
task=$(sed -n "${SLURM_ARRAY_TASK_ID}p" "${OPEN:-open.txt}")
test -n "$task"
exec tokosen work "${PLAN:-plan}" --task "$task" --threads "${SLURM_CPUS_PER_TASK:-1}"
