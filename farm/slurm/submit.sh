#!/usr/bin/env bash
# Submits what is missing of a job, and the merges that wait for it; prints the ids.
#
#   submit.sh JOB.json PICTURE [OPTION...]
#
# PICTURE is what the last merge writes, such as room.exr, beside the checkpoint room.film. The options go to the
# sbatch of the tasks: --cpus-per-task=8 --time=1:00:00. Submit again to complete what failed.
# GLOBILLUM is the program (globillum), FAN_IN how many parts one merge reads (64).
set -euo pipefail
[ $# -ge 2 ] || { echo "usage: submit.sh JOB.json PICTURE [OPTION...]" >&2; exit 1; }
job=$1 picture=$2
shift 2
case $job in
  *.json) ;;
  *) echo "submit.sh: $job: must end in .json" >&2; exit 1 ;;
esac
case ${picture,,} in
  *.png | *.exr) ;;
  *) echo "submit.sh: $picture: must end in .png or .exr" >&2; exit 1 ;;
esac
here=$(dirname "$0")
export GLOBILLUM=${GLOBILLUM:-globillum} JOB=$job PICTURE=$picture FAN_IN=${FAN_IN:-64}
[[ $FAN_IN =~ ^[1-9][0-9]*$ ]] || { echo "submit.sh: FAN_IN=$FAN_IN: must be a number above 0" >&2; exit 1; }
size=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p')
arrays=$("$GLOBILLUM" status "$job" --arrays --max-array-size "$size")
tasks=$(sed -n 's/^ *"tasks": *\([0-9]*\).*/\1/p' "$job")
groups=$(((tasks + FAN_IN - 1) / FAN_IN))
[ "$groups" -le "$size" ] || { echo "submit.sh: FAN_IN=$FAN_IN: more than $size merges" >&2; exit 1; }
logs=${job%.*}.logs
mkdir -p "$logs"

# Waits until the jobs named before it have ended, and prints the id. Merges check for themselves that nothing is
# missing: afterok would not start them if a task was run again, since an array remembers its largest exit code.
submit() { # LOG AFTER OPTION...
  local log=$1 after=$2
  shift 2
  sbatch --parsable --output="$logs/$log.out" ${after:+"--dependency=afterany$after"} "$@"
}

after=
while read -r offset indices; do
  [ -n "$indices" ] || continue # nothing is missing
  id=$(OFFSET=$offset submit "task-$offset-%a" "" --array="$indices" "$@" "$here/task.sbatch")
  echo "tasks $id $indices, offset $offset"
  after+=:$id
done <<< "$arrays"

# One merge of all parts, or an array of merges and one of theirs.
if [ "$groups" -gt 1 ]; then
  id=$(submit "merge-%a" "$after" --array="0-$((groups - 1))" "$here/merge.sbatch")
  echo "merges $id 0-$((groups - 1))"
  after=:$id
fi
id=$(GROUPS_MERGED=$groups submit picture "$after" "$here/picture.sbatch")
echo "picture $id"
