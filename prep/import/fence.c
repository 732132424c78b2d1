#include "prep/import/fence.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* ---- files ---- */

/* Constants of linux/landlock.h, which may be older than the kernel, or missing. */
enum {
    CALL_CREATE = 444,
    CALL_ADD = 445,
    CALL_RESTRICT = 446,
    CREATE_VERSION = 1,
    RULE_BENEATH = 1,
};

enum {
    ACCESS_EXECUTE = 1 << 0,
    ACCESS_WRITE_FILE = 1 << 1,
    ACCESS_READ_FILE = 1 << 2,
    ACCESS_READ_DIR = 1 << 3,
    ACCESS_REMOVE_FILE = 1 << 5,
    ACCESS_MAKE_REG = 1 << 8,
    ACCESS_REFER = 1 << 13,
    ACCESS_TRUNCATE = 1 << 14,
    ACCESS_IOCTL = 1 << 15,
    OF_FILES = ACCESS_EXECUTE | ACCESS_WRITE_FILE | ACCESS_READ_FILE | ACCESS_TRUNCATE,
};

typedef struct ruleset {
    uint64_t files, network, scopes;
} ruleset;

typedef struct __attribute__((packed)) beneath {
    uint64_t allowed;
    int32_t folder;
} beneath;

/* All rights that this version of Landlock knows: all are taken away. */
static uint64_t all_rights(int version) {
    uint64_t rights = ACCESS_REFER - 1;
    rights |= version >= 2 ? ACCESS_REFER : 0;
    rights |= version >= 3 ? ACCESS_TRUNCATE : 0;
    return rights | (version >= 5 ? ACCESS_IOCTL : 0);
}

bool fence_begin(fence *f) {
    enum { BIND_AND_CONNECT = 3, SOCKETS_AND_SIGNALS = 3 };
    f->version = (int)syscall(CALL_CREATE, NULL, (size_t)0, CREATE_VERSION);
    f->rules = -1;
    if (f->version < 1)
        return false;
    const ruleset all = {all_rights(f->version), f->version >= 4 ? BIND_AND_CONNECT : 0,
                         f->version >= 6 ? SOCKETS_AND_SIGNALS : 0};
    const size_t size = f->version >= 6   ? sizeof all
                        : f->version >= 4 ? offsetof(ruleset, scopes)
                                          : offsetof(ruleset, network);
    f->rules = (int)syscall(CALL_CREATE, &all, size, 0);
    return f->rules >= 0;
}

static uint64_t wanted(unsigned rights) {
    return (rights & FENCE_READ ? ACCESS_READ_FILE : 0) |
           (rights & FENCE_LIST ? ACCESS_READ_DIR : 0) |
           (rights & FENCE_WRITE
                ? ACCESS_WRITE_FILE | ACCESS_TRUNCATE | ACCESS_MAKE_REG | ACCESS_REMOVE_FILE
                : 0);
}

void fence_allow(fence *f, const char *path, unsigned rights) {
    struct stat info;
    const int fd = f->rules < 0 ? -1 : open(path, O_PATH | O_CLOEXEC);
    if (fd < 0)
        return;
    beneath rule = {.allowed = wanted(rights) & all_rights(f->version), .folder = fd};
    if (fstat(fd, &info) == 0 && !S_ISDIR(info.st_mode))
        rule.allowed &= OF_FILES;
    if (rule.allowed)
        syscall(CALL_ADD, f->rules, RULE_BENEATH, &rule, 0);
    close(fd);
}

static bool give_up_privileges(void) {
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
}

bool fence_close(fence *f) {
    if (f->rules < 0)
        return false;
    const bool closed = give_up_privileges() && syscall(CALL_RESTRICT, f->rules, 0) == 0;
    close(f->rules);
    f->rules = -1;
    return closed;
}

/* ---- calls ---- */

#if defined __x86_64__ && !defined __ILP32__
#define MACHINE AUDIT_ARCH_X86_64
#elif defined __aarch64__ && defined __AARCH64EL__
#define MACHINE AUDIT_ARCH_AARCH64
#endif

#ifdef MACHINE

/* Call numbers newer than some headers. They are the same on all machines. */
enum {
    CALL_PIDFD_SIGNAL = 424,
    CALL_IO_URING = 425,
    CALL_OPEN_TREE = 428,
    CALL_MOVE_MOUNT = 429,
    CALL_PIDFD_OPEN = 434,
    CALL_CLONE3 = 435,
    CALL_PIDFD_GETFD = 438,
    CALL_MOUNT_SETATTR = 442,
    CALL_FCHMODAT2 = 452,
    FOREIGN_NUMBERS = 0x40000000 /* x32 has its own numbers from here on */
};

static const int refused[] = {
    /* No network, no programs, no access to other processes, no signals to them. */
    SYS_socket,
    SYS_socketpair,
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_kcmp,
    SYS_perf_event_open,
    SYS_bpf,
    SYS_userfaultfd,
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    SYS_kill,
    SYS_tkill,
    SYS_rt_sigqueueinfo,
    CALL_PIDFD_SIGNAL,
    CALL_PIDFD_OPEN,
    CALL_PIDFD_GETFD,
    /* File operations that Landlock does not restrict: modes, owners, attributes, lengths,
     * mounts. */
    SYS_fchmod,
    SYS_fchmodat,
    CALL_FCHMODAT2,
    SYS_fchown,
    SYS_fchownat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    SYS_utimensat,
    SYS_truncate,
    SYS_open_by_handle_at,
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_unshare,
    SYS_setns,
    CALL_OPEN_TREE,
    CALL_MOVE_MOUNT,
    CALL_MOUNT_SETATTR,
    /* Control of the machine, for processes of root. */
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_acct,
    SYS_quotactl,
    SYS_syslog,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
#ifdef __x86_64__
    SYS_fork,
    SYS_vfork,
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
    SYS_ioperm,
    SYS_iopl,
#endif
};

enum { REFUSED = sizeof refused / sizeof *refused, STEPS_MAX = 2 * REFUSED + 32 };

typedef struct filter {
    struct sock_filter step[STEPS_MAX];
    unsigned short steps;
} filter;

static void load(filter *f, size_t at) {
    f->step[f->steps++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)at);
}

static void answer(filter *f, uint32_t how) {
    f->step[f->steps++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, how);
}

/* The next `skip` steps run only if the test passes. */
static void only_if(filter *f, int test, uint32_t value, uint8_t skip) {
    f->step[f->steps++] =
        (struct sock_filter)BPF_JUMP((uint16_t)(BPF_JMP | test | BPF_K), value, 0, skip);
}

static void fail(filter *f, int call, int error) {
    only_if(f, BPF_JEQ, (uint32_t)call, 1);
    answer(f, SECCOMP_RET_ERRNO | (uint32_t)error);
}

/* Fail unless the first argument passes the test (its low half: both machines are little
 * endian). */
static void fail_unless(filter *f, int call, int test, uint32_t value) {
    only_if(f, BPF_JEQ, (uint32_t)call, 4);
    load(f, offsetof(struct seccomp_data, args));
    only_if(f, test, value, 1);
    answer(f, SECCOMP_RET_ALLOW);
    answer(f, SECCOMP_RET_ERRNO | EPERM);
}

static void write_filter(filter *f) {
    load(f, offsetof(struct seccomp_data, arch));
    only_if(f, BPF_JEQ, MACHINE, 1);
    f->step[f->steps++] = (struct sock_filter)BPF_STMT(BPF_JMP | BPF_JA, 1);
    answer(f, SECCOMP_RET_KILL_PROCESS);
    load(f, offsetof(struct seccomp_data, nr));
    only_if(f, BPF_JGE, FOREIGN_NUMBERS, 1);
    answer(f, SECCOMP_RET_ERRNO | ENOSYS);
    for (size_t i = 0; i < REFUSED; i++)
        fail(f, refused[i], EPERM);
    fail(f, CALL_IO_URING, ENOSYS);
    /* Allow threads, but no processes. clone3() hides its flags: the C library falls back to
     * clone(). */
    fail(f, CALL_CLONE3, ENOSYS);
    fail_unless(f, SYS_clone, BPF_JSET, CLONE_THREAD);
    /* abort() ends the process by a signal to one of its own threads: allow that. */
    fail_unless(f, SYS_tgkill, BPF_JEQ, (uint32_t)getpid());
    answer(f, SECCOMP_RET_ALLOW);
}

bool fence_calls(void) {
    filter f = {.steps = 0};
    write_filter(&f);
    const struct sock_fprog program = {f.steps, f.step};
    /* No secrets of this process are kept from itself, so speculation may stay on, for speed. */
    return give_up_privileges() &&
           syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER,
                   SECCOMP_FILTER_FLAG_TSYNC | SECCOMP_FILTER_FLAG_SPEC_ALLOW, &program) == 0;
}

#else

bool fence_calls(void) {
    return false;
}

#endif
