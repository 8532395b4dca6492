// A plugin of qemu's user mode emulation: counts the executed instructions per function of the program,
// for one thread. Writes lines "COUNT FUNCTION" (mangled) to the file given as out=FILE.
// Build: cc -shared -fPIC; run: qemu-aarch64 -plugin FILE.so,out=COUNTS PROGRAM.
// No package has qemu-plugin.h, so the few functions of version 1 of its interface are declared here.
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
typedef struct qemu_info_t qemu_info_t;
struct qemu_plugin_tb;    // a translated block of instructions
struct qemu_plugin_insn;  // an instruction
enum { kAddToU64 = 0 };   // QEMU_PLUGIN_INLINE_ADD_U64

void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*translated)(qemu_plugin_id_t id,
                                                              struct qemu_plugin_tb* block));
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb* block, int operation, void* to,
                                              uint64_t value);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, void (*ended)(qemu_plugin_id_t id, void*),
                                    void* data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb* block);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb* block, size_t index);
const char* qemu_plugin_insn_symbol(const struct qemu_plugin_insn* instruction);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

enum { kMaxFunctions = 1 << 16 };
static struct {
  const char* name;  // as qemu returns it: equal names have equal addresses
  uint64_t count;
} functions[kMaxFunctions];
static const char* out_file;

static uint64_t* counter_of(const char* name) {
  int i = 0;
  while (i < kMaxFunctions - 1 && functions[i].name != NULL && functions[i].name != name) ++i;
  functions[i].name = name;
  return &functions[i].count;
}

static void count(qemu_plugin_id_t id, struct qemu_plugin_tb* block) {
  (void)id;
  const char* name = qemu_plugin_insn_symbol(qemu_plugin_tb_get_insn(block, 0));
  if (name == NULL) name = "";
  qemu_plugin_register_vcpu_tb_exec_inline(block, kAddToU64, counter_of(name),
                                           qemu_plugin_tb_n_insns(block));
}

static void write_counts(qemu_plugin_id_t id, void* data) {
  (void)id;
  (void)data;
  FILE* out = fopen(out_file, "w");
  if (out == NULL) return;
  for (int i = 0; i < kMaxFunctions && functions[i].name != NULL; ++i) {
    fprintf(out, "%llu %s\n", (unsigned long long)functions[i].count,
            functions[i].name[0] == '\0' ? "?" : functions[i].name);
  }
  fclose(out);
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id,
                                                               const qemu_info_t* info, int argc,
                                                               char** argv) {
  (void)info;
  for (int i = 0; i < argc; ++i) {
    if (strncmp(argv[i], "out=", 4) == 0) out_file = argv[i] + 4;
  }
  if (out_file == NULL) {
    fprintf(stderr, "count_instructions: out=FILE is missing\n");
    return -1;
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, count);
  qemu_plugin_register_atexit_cb(id, write_counts, NULL);
  return 0;
}
