#!/usr/bin/env bash
# Runs docs/cluster for real, on a Slurm of one node that is started here. Needs root and Debian's slurmctld, slurmd, slurm-client and munge.
#
#     tests/cluster/run.sh [PROGRAM]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
export VORONUDGE=${1:-$root/target/release/voronudge}
scratch=$(mktemp -d)
slurm=$scratch/slurm host=$(hostname -s)
mkdir -p "$slurm"/{state,spool,log}

stop() {
    for name in slurmd slurmctld munged; do
        [ -f "$slurm/$name.pid" ] && kill "$(cat "$slurm/$name.pid")" 2>/dev/null || true
    done
    wait
    rm -rf "$scratch"
}
trap stop EXIT

install -d -o munge -g munge -m 0755 /run/munge
install -d -o munge -g munge -m 0700 /var/log/munge /var/lib/munge
if [ ! -f /etc/munge/munge.key ]; then
    head -c 1024 /dev/urandom >/etc/munge/munge.key
    chown munge: /etc/munge/munge.key
    chmod 400 /etc/munge/munge.key
fi
setpriv --reuid munge --regid munge --clear-groups munged --foreground >"$slurm/log/munged" 2>&1 &
echo $! >"$slurm/munged.pid"
cat >"$slurm/slurm.conf" <<CONF
ClusterName=tests
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.own
SlurmdPidFile=$slurm/slurmd.own
SlurmctldLogFile=$slurm/log/slurmctld
SlurmdLogFile=$slurm/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MpiDefault=none
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=1000 State=UNKNOWN
PartitionName=tests Nodes=$host Default=YES State=UP
CONF
export SLURM_CONF=$slurm/slurm.conf SBATCH_TIMELIMIT=5
for _ in $(seq 50); do munge -n >/dev/null 2>&1 && break || sleep 0.1; done
slurmctld -D -f "$SLURM_CONF" >"$slurm/log/slurmctld.out" 2>&1 &
echo $! >"$slurm/slurmctld.pid"
slurmd -D -f "$SLURM_CONF" -N "$host" >"$slurm/log/slurmd.out" 2>&1 &
echo $! >"$slurm/slurmd.pid"
for _ in $(seq 100); do sinfo --noheader -o %t 2>/dev/null | grep -q idle && break || sleep 0.2; done
sinfo --noheader -o %t | grep -q idle

submit=$root/docs/cluster/submit.sh
# A part takes some seconds: it still runs when it is requeued or killed.
diagram=(phase-diagram --P_0 3.5 4 2 --alpha 0.5 1 2 --replicas 4 --cells 100 --time 60 --seed 5)
cd "$scratch"
"$VORONUDGE" "${diagram[@]}" --quiet --out single

same() {
    for file in single/*.npy single/points.jsonl; do
        cmp "$file" "$1/whole/${file#single/}"
    done
    echo "$2: the same bytes as in one run"
}

# Waits until a job has run for a moment.
runs() {
    for _ in $(seq 100); do squeue --noheader --states running --jobs "$1" 2>/dev/null | grep -q . && break || sleep 0.1; done
    sleep 0.5
}

WAIT=1 "$submit" shared 4 "${diagram[@]}"
same shared "an array of four parts"

# Submitted again: what is there is not made again, what is missing is.
rm -r shared/part-3
cp shared/part-1/points.jsonl kept
WAIT=1 "$submit" shared 4 "${diagram[@]}"
same shared "a resubmission"
cmp kept shared/part-1/points.jsonl

# Requeued while it runs.
"$submit" requeued 4 "${diagram[@]}" >told
job=$(grep -o 'job [0-9]*' told | head -1 | cut -d' ' -f2)
runs "${job}_1"
scontrol requeue "${job}_1"
while squeue --noheader | grep -q .; do
    # A requeued job waits for two minutes, if nobody lets it go.
    scontrol release "${job}_1" 2>/dev/null || true
    scontrol update jobid="${job}_1" starttime=now 2>/dev/null || true
    sleep 1
done
same requeued "a part that was requeued"

# A part that is killed is noticed.
WAIT=1 "$submit" killed 4 "${diagram[@]}" >begun 2>error &
waiting=$!
for _ in $(seq 100); do [ -s begun ] && break || sleep 0.1; done
job=$(grep -o 'job [0-9]*' begun | head -1 | cut -d' ' -f2)
runs "${job}_2"
scancel "${job}_2"
if wait "$waiting"; then
    echo "the merge of three parts of four ended well" >&2
    exit 1
fi
grep "this part was interrupted" error || { cat error killed/log-merge.txt >&2; exit 1; }
test ! -e killed/whole
echo "a part that was killed: noticed"
# Slurm sends SIGTERM first: what was made is kept, and the next submission goes on.
grep "which are kept" killed/log-2.txt
WAIT=1 "$submit" killed 4 "${diagram[@]}"
same killed "a submission after that"
