"""Many cases: tasks done in this process, in processes beside it, or on a cluster; time limits."""
