#!/usr/bin/env bash
# A Slurm cluster of two nodes on this host, below an ordinary folder: to try `evbench sweep --executor slurm`, and for
# its test. Needs Debian's slurm-wlm and root. Nothing outside of the folder is touched.
#
#   one_host_cluster.sh start DIR    starts it; then: export SLURM_CONF=DIR/slurm.conf, and sbatch, squeue, scontrol work
#   one_host_cluster.sh stop DIR     ends it with all of its jobs; DIR can then be removed
#
# The nodes are node1 and node2, with two processors each; `scontrol update nodename=node1 state=down reason=test` takes
# one down, `state=resume` brings it back.
set -euo pipefail

usage() { sed -n '5,6s/^# *//p' "$0" >&2; exit 2; }
[ $# -eq 2 ] || usage

# The first of three free ports in a row.
free_ports() {
  local port busy
  busy=$(cat /proc/net/tcp /proc/net/tcp6 2>/dev/null | awk '{split($2, a, ":"); print a[2]}')
  for ((port = 20000 + $$ % 10000; port < 40000; port += 3)); do
    local taken=
    for offset in 0 1 2; do
      grep -qiE "^$(printf '%04X' $((port + offset)))$" <<<"$busy" && taken=yes
    done
    [ -z "$taken" ] && { echo "$port"; return; }
  done
  echo "one_host_cluster.sh: no three free ports" >&2
  exit 1
}

pids() { cat "$1"/*.pid 2>/dev/null || true; }

start() {
  command -v slurmctld >/dev/null && command -v slurmd >/dev/null || { echo "one_host_cluster.sh: slurmctld and slurmd are needed (Debian: slurm-wlm)" >&2; exit 1; }
  mkdir -p "$1"
  local dir port host memory
  dir=$(realpath "$1")
  port=$(free_ports)
  host=$(hostname -s)
  memory=$(awk '/MemTotal/ {print int($2 / 1024)}' /proc/meminfo)
  mkdir -p "$dir/state" "$dir/node1" "$dir/node2"
  # Timeouts are short: what a cluster does within minutes is to be seen within seconds.
  cat >"$dir/slurm.conf" <<CONF
ClusterName=one_host
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1
ReturnToService=1
KillWait=2
SlurmdTimeout=10
SlurmctldTimeout=10
InactiveLimit=0
MinJobAge=300
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/%n
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/%n.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/%n.log
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=2 RealMemory=$memory State=UNKNOWN
NodeName=node2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=2 RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
CONF
  # Slurm 23 and later ask for control groups, which containers may not have; earlier versions do not know the setting.
  [ "$(slurmd -V | grep -o '[0-9]*' | head -n1)" -lt 23 ] || echo CgroupPlugin=disabled >"$dir/cgroup.conf"
  export SLURM_CONF=$dir/slurm.conf
  slurmctld
  slurmd -N node1
  slurmd -N node2
  for _ in $(seq 100); do
    [ "$(sinfo -h -N -o %T 2>/dev/null | grep -c idle)" -eq 2 ] && { echo "export SLURM_CONF=$dir/slurm.conf"; return; }
    sleep 0.2
  done
  echo "one_host_cluster.sh: the nodes do not come up; see $dir/*.log" >&2
  stop "$dir"
  exit 1
}

stop() {
  SLURM_CONF=$1/slurm.conf scancel --user="$(id -un)" --signal=KILL 2>/dev/null || true
  local pid
  for pid in $(pids "$1"); do kill "$pid" 2>/dev/null || true; done
  for _ in $(seq 50); do
    local alive=
    for pid in $(pids "$1"); do kill -0 "$pid" 2>/dev/null && alive=yes; done
    [ -z "$alive" ] && return
    sleep 0.1
  done
  for pid in $(pids "$1"); do kill -9 "$pid" 2>/dev/null || true; done
}

case $1 in
  start) start "$2" ;;
  stop) stop "$2" ;;
  *) usage ;;
esac
