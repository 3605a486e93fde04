#!/usr/bin/env bash
# Starts a real Slurm on this machine, from its Debian packages, and tries the job scripts of examples/slurm/ with it: shards as a job array, of which a task is killed and
# submitted again, and the merge as a dependent job. The result must be that of the sweep in one piece.
#
#   bash tests/slurm.sh target/release/pbif
#
# Exit status 77 where Slurm is not installed (apt-get install slurmctld slurmd slurm-client munge) or cannot be started, with the reason.
set -euo pipefail
pbif=$(realpath "${1:?which pbif?}")
root=$(realpath "$(dirname "$0")/..")
skip() { echo "skipped: $*"; exit 77; }
for program in slurmctld slurmd munged sbatch; do
  PATH=$PATH:/usr/sbin command -v "$program" > /dev/null || skip "there is no $program"
done
[ "$(id -u)" -eq 0 ] || skip 'Slurm is started by root here'
export PATH=$PATH:/usr/sbin

top=$(mktemp -d /tmp/pbif-slurm-XXXXXX)
started=()
finish() {
  local status=$?
  [ "$status" -eq 0 ] || [ "$status" -eq 77 ] || tail -n 20 "$top"/slurm*.log "$top"/slurm-*.out 2> /dev/null || true
  for process in "${started[@]}"; do kill "$process" 2> /dev/null || true; done
  for process in "${started[@]}"; do wait "$process" 2> /dev/null || true; done
  rm -rf "$top"
  exit "$status"
}
trap finish EXIT
chmod 755 "$top"

# A cluster of one node, with everything it keeps below one folder.
mkdir -m 700 "$top/munge"
head -c 128 /dev/urandom > "$top/munge/key"
chmod 400 "$top/munge/key"
munged --foreground --force --key-file "$top/munge/key" --socket "$top/munge.socket" --pid-file "$top/munge/pid" --log-file "$top/munge.log" --seed-file "$top/munge/seed" \
  > "$top/munged.log" 2>&1 &
started+=($!)
mkdir "$top/state" "$top/spool"
port=$((20000 + RANDOM % 20000))
cat > "$top/slurm.conf" <<CONF
ClusterName=pbif
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$top/munge.socket
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=10000,bf_interval=1
SlurmdParameters=config_overrides
ReturnToService=2
StateSaveLocation=$top/state
SlurmdSpoolDir=$top/spool
SlurmctldPidFile=$top/slurmctld.pid
SlurmdPidFile=$top/slurmd.pid
SlurmctldLogFile=$top/slurmctld.log
SlurmdLogFile=$top/slurmd.log
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$top/slurm.conf
slurmctld -D > "$top/slurmctld.out" 2>&1 &
started+=($!)
slurmd -D > "$top/slurmd.out" 2>&1 &
started+=($!)
for _ in $(seq 60); do
  [ "$(sinfo -h -o %T 2> /dev/null)" = idle ] && break
  sleep 0.5
done
[ "$(sinfo -h -o %T 2> /dev/null)" = idle ] || { tail -n 5 "$top"/slurm*.log "$top"/*.out; skip 'the node does not come up'; }

# The program as users have it: one file in the PATH, a sweep file that says everything.
mkdir "$top/tools"
ln -s "$pbif" "$top/tools/pbif"
export PATH=$top/tools:$PATH
cd "$top"
pbif sweep "$root/sweeps/rayleigh_crater.toml" --set cells.x.count=64 --set cells.y.count=64 --set sweep.points=13 --set 'figures.draw=[]' --out whole --quiet > /dev/null || [ $? -eq 1 ]
pbif show whole --sweep > crater.toml

# Jobs are looked at once a second until they are in this state; the script ends after two minutes.
state() { scontrol -o show job "$1" 2> /dev/null | grep -o 'JobState=[A-Z]*' | sort -u | tr '\n' ' '; }
await() {
  for _ in $(seq 120); do
    case $(state "$1") in *RUNNING*|*PENDING*|*COMPLETING*|*CONFIGURING*|*REQUEUED*) sleep 1;; *) return 0;; esac
  done
  echo "job $1 does not end: $(state "$1")"; exit 1
}

# Shard 2 is killed as a node that fails kills it: nothing is said to pbif.
array=$(sbatch --parsable --cpus-per-task=1 --array=1-4 "$root/examples/slurm/shards.sh" crater.toml run)
echo "array $array"
for _ in $(seq 600); do
  rows=$({ cat run/shards/2-of-4/points.csv 2> /dev/null || true; } | wc -l)
  [ "$rows" -ge 2 ] && break
  sleep 0.05
done
kill -KILL "$(grep -o -m 1 '[0-9]\+' run/shards/2-of-4/.pbif.lock | head -n 1)"
await "$array"
[ "$(grep -c '"ending": "complete"' run/shards/*/run.json | grep -c ':1$')" -ge 3 ] || { echo 'the other shards are not complete'; exit 1; }
if grep -q '"ending": "running"' run/shards/2-of-4/run.json; then
  echo "shard 2 was killed after $(($(wc -l < run/shards/2-of-4/points.csv) - 1)) points"
else
  echo 'shard 2 was done before it could be killed'; exit 1
fi
status=0
pbif merge run > refused.txt 2>&1 || status=$?
{ [ "$status" -eq 2 ] && grep -q '2/4' refused.txt; } || { cat refused.txt; echo 'a missing shard is not named'; exit 1; }

# It goes on as it was submitted, and the merge waits for it.
again=$(sbatch --parsable --cpus-per-task=1 --array=2 "$root/examples/slurm/shards.sh" crater.toml run 4)
merge=$(sbatch --parsable --cpus-per-task=2 --dependency="afterok:$again" "$root/examples/slurm/merge.sh" run)
await "$again"
await "$merge"
grep -q 'points are done already' slurm-"${again}"_2.out || { echo 'shard 2 began anew'; exit 1; }
pbif verify run

# Located values agree within a thousandth of their errors.
python3 - whole/bifurcations.csv run/bifurcations.csv <<'PY' 2> compared.txt || { cat compared.txt; exit 1; }
import csv, sys
whole, merged = ([row for row in csv.DictReader(open(name))] for name in sys.argv[1:])
assert len(whole) == len(merged) > 0, (len(whole), len(merged))
for a, b in zip(whole, merged):
    for column in ('label', 'observable', 'before', 'after', 'status'):
        assert a[column] == b[column], (a, b)
    error = float(a['error'] or 0)
    assert abs(float(a['value']) - float(b['value'])) <= 1e-3 * error, (a, b)
print(f'{len(whole)} rows of four shards, one of them killed, are those of the sweep in one piece')
PY
