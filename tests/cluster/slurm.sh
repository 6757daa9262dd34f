#!/bin/bash
# A sweep of a thousand items on Slurm: four nodes on this machine, one of which is killed in the middle, and a task that is queued again.
# Nothing may be lost or twice, and the merged result must be that of one machine, byte for byte.
#
#     sudo tests/cluster/slurm.sh build/app/wisp
#
# Needs slurm-wlm and munge. All daemons and files are in a folder of their own, which is removed.
set -euo pipefail

wisp=$(realpath "$1")
here=$(mktemp -d /tmp/wisp-slurm-XXXXXX)
host=$(hostname -s)
shards=16

say() { printf 'slurm: %s\n' "$*"; }
fail()
{
    say "$*" >&2
    tail -n 5 "$here"/*.log >&2 || true
    exit 1
}

stop()
{
    pkill -9 -f "$here" || true
    rm -rf "$here"
}
trap stop EXIT

# ---- daemons ----

mkdir -p "$here"/{state,spool-n{1,2,3,4},cache}
dd if=/dev/urandom of="$here/key" bs=1024 count=1 status=none
chmod 600 "$here/key"
cat > "$here/slurm.conf" <<END
ClusterName=wisp
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$here/munge.socket
SlurmctldPort=26817
StateSaveLocation=$here/state
SlurmdSpoolDir=$here/spool-%n
SlurmctldPidFile=$here/slurmctld.pid
SlurmdPidFile=$here/slurmd-%n.pid
SlurmctldLogFile=$here/slurmctld.log
SlurmdLogFile=$here/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/linear
SchedulerType=sched/builtin
ReturnToService=2
SlurmdTimeout=10
KillWait=2
MpiDefault=none
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=26821 CPUs=1
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=26822 CPUs=1
NodeName=n3 NodeHostname=$host NodeAddr=127.0.0.1 Port=26823 CPUs=1
NodeName=n4 NodeHostname=$host NodeAddr=127.0.0.1 Port=26824 CPUs=1
PartitionName=all Nodes=n[1-4] Default=YES State=UP
END
export SLURM_CONF=$here/slurm.conf
munged --force --key-file="$here/key" --socket="$here/munge.socket" --pid-file="$here/munged.pid" \
    --log-file="$here/munged.log" --seed-file="$here/munged.seed"
slurmctld -f "$SLURM_CONF"
for node in n1 n2 n3 n4; do
    slurmd -f "$SLURM_CONF" -N "$node"
done
for _ in $(seq 60); do
    [ "$(sinfo --noheader --states=idle --format=%D 2>/dev/null)" = 4 ] && break
    sleep 0.5
done
[ "$(sinfo --noheader --states=idle --format=%D)" = 4 ] || fail "four nodes did not come up: $(sinfo --noheader)"

# ---- a suite of a thousand items ----

cat > "$here/sheet.yaml" <<END
wisp: 1
steps: 40
surfaces:
  - name: sheet
    generate: { shape: plane, columns: 17, rows: 17, spacing: 0.03 }
    pins: [0, 16]
    cloth: { warp_compliance: 1e-3, bending: dihedral }
END
list() { seq -s ', ' "$@"; }
cat > "$here/suite.yaml" <<END
wisp_suite: 1
title: a thousand sheets
reference: { set: { substeps: 40 }, check: { substeps: 20 } }
scenes:
  - file: sheet.yaml
    vary: { "surfaces[0].damping": [$(list 0 19)], "surfaces[0].area_density": [$(list 0.1 0.1 1)] }
    along: { substeps: [1, 2, 4, 8, 16] }
    order: 1
END
export WISP_CACHE=$here/cache
"$wisp" sweep "$here/suite.yaml" -o "$here/one"
"$wisp" merge "$here/one" -f json -o "$here/one.json" --report "$here/one.html"

# ---- the cluster ----

cat > "$here/job.sh" <<END
#!/bin/bash
exec "$wisp" sweep "$here/suite.yaml" -o "$here/parts" --resume
END
job=$(sbatch --parsable --array=1-$shards --requeue --open-mode=append --output="$here/task-%a.log" "$here/job.sh")
say "job $job: $shards tasks on 4 nodes"

# the task that runs on a node, and the number of its job
task_on() { squeue --noheader --nodelist="$1" --states=running --array --format=%K; }
job_on() { squeue --noheader --nodelist="$1" --states=running --array --format=%A; }
has_lines() { [ "$(cat "$here"/parts/*.running 2>/dev/null | wc -l)" -gt 20 ]; }
for _ in $(seq 200); do
    [ -n "$(task_on n2)" ] && [ -n "$(task_on n3)" ] && has_lines && break
    sleep 0.05
done
killed=$(task_on n2)
again=$(task_on n3)
[ -n "$killed" ] && [ -n "$again" ] || fail "the sweep was over before a node could be killed"
# as if it had lost its power: first those that would tell
step=$(job_on n2)
stepd=""
for pid in $(pgrep -f "slurmstepd: \[$step\."); do
    # not that of another Slurm on this machine
    if tr '\0' '\n' < "/proc/$pid/environ" | grep -q "$here"; then stepd=$pid; fi
done
[ -n "$stepd" ] || fail "nothing runs on n2"
kill -9 "$stepd"
pkill -9 -f "slurmd -f $SLURM_CONF -N n2"
part=$(printf '%s/parts/part-%04d-of-%04d.running' "$here" "$killed" $shards)
fuser -k -KILL "$part" > /dev/null 2>&1 || true
say "node n2 is killed with task $killed, after $(($(cat "$part" 2>/dev/null | wc -l) - 1)) of its items"
scontrol requeue "${job}_$again"
say "task $again is queued again"

# Slurm waits two minutes before it starts what is queued again
for _ in $(seq 240); do
    [ -z "$(squeue --noheader --jobs="$job" 2>/dev/null)" ] && break
    for task in "$killed" "$again"; do
        [ "$(squeue --noheader --jobs="${job}_$task" --format=%r 2>/dev/null)" != BeginTime ] ||
            scontrol update JobId="${job}_$task" StartTime=now
    done
    sleep 0.5
done
[ -z "$(squeue --noheader --jobs="$job" 2>/dev/null)" ] || fail "tasks are left: $(squeue --noheader --jobs="$job")"
say "nodes at the end: $(sinfo --noheader --format='%N %T' | paste -sd, -)"
for task in "$killed" "$again"; do
    grep -h "from before" "$here/task-$task.log" || fail "task $task did not go on with what was there"
done

"$wisp" merge "$here/parts" -f json -o "$here/parts.json" --report "$here/parts.html"
items=$(grep -c '"case"' "$here/parts.json")
[ "$items" = 1000 ] || fail "the merged result has $items items"
cmp "$here/one.json" "$here/parts.json"
cmp "$here/one.html" "$here/parts.html"
say "1000 items, the same bytes as on one machine"
