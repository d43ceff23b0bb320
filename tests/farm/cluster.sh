#!/bin/sh
# cluster.sh start|stop FOLDER -- a real Slurm of two nodes of one processor on this machine's loopback address, for
# tests. Its files are in FOLDER; FOLDER/env sets what srun and sbatch need. Ends with 77 where Slurm is not installed
# (Debian: slurm-wlm, munge) or this user is not root. Memory is limited: Slurm looks each second at the processes of a
# job (OverMemoryKill), because a cgroup is not ours to make everywhere.
folder=$2
start() {
  for program in munged slurmctld slurmd srun; do
    command -v $program > /dev/null || PATH=$PATH:/usr/sbin command -v $program > /dev/null ||
      { echo "skipped: there is no $program (Debian: slurm-wlm, munge)"; exit 77; }
  done
  [ "$(id -u)" = 0 ] || { echo 'skipped: the daemons of Slurm need root'; exit 77; }
  mkdir -p "$folder/state" && chmod 755 "$folder" || exit 3
  dd if=/dev/urandom of="$folder/munge.key" bs=1024 count=1 2> /dev/null && chmod 400 "$folder/munge.key"
  port=$(($$ % 10000 + 20000))   # two tests at once have other ports
  host=$(uname -n)
  cat > "$folder/slurm.conf" << END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
JobAcctGatherParams=OverMemoryKill
AccountingStorageType=accounting_storage/none
ReturnToService=2
SlurmdTimeout=10
KillWait=2
InactiveLimit=20
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=10000
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + 2))] CPUs=1 RealMemory=2000
PartitionName=all Nodes=n[1-2] Default=YES MaxTime=1:00:00 State=UP
END
  echo "export SLURM_CONF='$folder/slurm.conf' PATH=\"\$PATH:/usr/sbin\"" > "$folder/env"
  . "$folder/env"
  munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/munged.seed" > "$folder/said" 2>&1 || { cat "$folder/said"; exit 3; }
  slurmctld && slurmd -N n1 && slurmd -N n2 || exit 3
  for round in $(seq 150); do
    [ "$(sinfo -h -o %D -t idle 2> /dev/null)" = 2 ] && exit 0
    sleep .2
  done
  sinfo; tail "$folder"/*.log
  exit 3
}
stop() {
  . "$folder/env" 2> /dev/null
  scancel -u root 2> /dev/null
  for round in $(seq 50); do [ -n "$(squeue -h 2> /dev/null)" ] || break; sleep .2; done   # the processes of jobs end
  for pid in "$folder"/*.pid; do [ ! -f "$pid" ] || kill "$(cat "$pid")" 2> /dev/null; done
  for round in $(seq 50); do
    left=
    for pid in "$folder"/*.pid; do [ -f "$pid" ] && [ -d "/proc/$(cat "$pid")" ] && left=yes; done
    [ -n "$left" ] || exit 0
    sleep .2
  done
  for pid in "$folder"/*.pid; do [ ! -f "$pid" ] || kill -9 "$(cat "$pid")" 2> /dev/null; done
}
case $1 in
  start | stop) $1;;
  *) echo "cluster.sh: '$1' is none of start, stop" >&2; exit 2;;
esac
