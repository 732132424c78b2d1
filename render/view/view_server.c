#include "render/view/view_server.h"

#include <arpa/inet.h>
#include <libwebsockets.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/clock.h"
#include "render/view/view_access.h"
#include "render/view/view_crowd.h"
#include "render/view/view_draw.h"
#include "render/view/view_listen.h"
#include "render/view/view_page.h"
#include "render/view/view_saved.h"
#include "render/view/view_talk.h"

enum {
    CONNECTIONS_MAX = 2 * VIEW_CROWD_MAX,
    CHUNK = 16 << 10, /* bytes of a body that are sent at a time */
    HEAD_MAX = 2048,  /* bytes of an answer's head */
    HOST_MAX = 300,
    REQUEST_S = 10, /* time to send a request */
    PING_S = 20,
    HANGUP_S = 45, /* until a silent socket is closed */
    TICK_US = 500000,
    REFRESH_S = 1,  /* how often files are asked for further steps, while a page is open */
    GONE_US = 50000 /* how often to check whether clients that wait for a picture have left */
};
_Static_assert(LWS_PRE <= VIEW_MESSAGE_BEFORE, "frames' heads fit before a message");

/* An HTTP request or a WebSocket. */
typedef struct session {
    struct session *next; /* next of those with a talk or a seat */
    struct lws *wsi;
    view_talk *talk;           /* of a WebSocket */
    view_seat *seat;           /* of a request for a picture as a file */
    view_message *drawn;       /* that picture, once it is drawn */
    bool exr;                  /* it is an EXR, else a PNG */
    const unsigned char *body; /* rest of the body to send */
    size_t left;               /* and its bytes */
    char host[HOST_MAX];       /* the Host header, once checked */
} session;

struct view_server {
    mem *m;
    view_server_options options;
    view_draw *draw;
    struct lws_context *context;
    struct lws_vhost *vhost;
    session *sessions;
    view_crowd crowd;
    char url[HOST_MAX + VIEW_TOKEN_TEXT + 32];
    char argument[VIEW_HEADERS_MAX];
    char own[HOST_MAX]; /* its name in Host headers beside localhost; "": none */
    bool (*stop)(void *ctx);
    void *stop_ctx;
    double refreshed; /* when view_draw_refresh() was called last */
    lws_sorted_usec_list_t tick;
};

static view_server *server_of(struct lws *wsi) {
    return lws_context_user(lws_get_context(wsi));
}

/* ---- Access ---- */

/* Copy a header, "" if there is none. Returns false if it is too long. */
static bool header(struct lws *wsi, enum lws_token_indexes which, char *out, int room) {
    out[0] = 0;
    return lws_hdr_total_length(wsi, which) == 0 || lws_hdr_copy(wsi, out, room, which) > 0;
}

/* Get this machine's address at which a connection came in, in the form of a Host header; "": none.
 * A Host that names it is safe: with DNS rebinding it would be another site's name. */
static void local_address(struct lws *wsi, char out[HOST_MAX]) {
    static const char mapped[] = "::ffff:"; /* IPv4 by a socket of IPv6 */
    struct sockaddr_storage at;
    socklen_t size = sizeof at;
    char text[NI_MAXHOST];
    out[0] = 0;
    if (getsockname(lws_get_socket_fd(wsi), (struct sockaddr *)&at, &size) != 0 ||
        getnameinfo((struct sockaddr *)&at, size, text, sizeof text, NULL, 0, NI_NUMERICHOST) != 0)
        return;
    const bool v4 = strncmp(text, mapped, sizeof mapped - 1) == 0;
    snprintf(out, HOST_MAX, v4 || !strchr(text, ':') ? "%.*s" : "[%.*s]", HOST_MAX - 3,
             v4 ? text + sizeof mapped - 1 : text);
}

static bool is_own_page(struct lws *wsi, char host[HOST_MAX]) {
    char origin[HOST_MAX], local[HOST_MAX];
    const view_server *s = server_of(wsi);
    local_address(wsi, local);
    return header(wsi, WSI_TOKEN_HOST, host, HOST_MAX) &&
           (view_access_host(host, s->own) || view_access_host(host, local)) &&
           header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof origin) &&
           (!origin[0] || view_access_origin(origin, host));
}

/* Returns the decoded value of "name=" in the address, or "". Valid until the next call. */
static const char *argument(struct lws *wsi, const char *name) {
    view_server *s = server_of(wsi);
    const char *text = lws_get_urlarg_by_name(wsi, name, s->argument, (int)sizeof s->argument);
    return text ? text : "";
}

static bool has_token(struct lws *wsi) {
    return view_access_same(server_of(wsi)->options.token, argument(wsi, "token="));
}

/* ---- Answers ---- */

static int answer_status(struct lws *wsi, unsigned code, const char *why) {
    unsigned char buffer[LWS_PRE + HEAD_MAX], *const start = buffer + LWS_PRE, *at = start,
                                                     *const end = buffer + sizeof buffer;
    const size_t size = strlen(why);
    if (lws_add_http_common_headers(wsi, code, "text/plain; charset=utf-8", size, &at, end) ||
        lws_finalize_http_header(wsi, &at, end) || size > (size_t)(end - at))
        return -1;
    memcpy(at, why, size);
    at += size;
    if (lws_write(wsi, start, (size_t)(at - start), LWS_WRITE_HTTP_FINAL) < 0)
        return -1;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **at,
                       unsigned char *end) {
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name,
                                       (const unsigned char *)value, (int)strlen(value), at,
                                       end) == 0;
}

/* Send the head now; send the body when the socket is writable. */
static int answer_body(struct lws *wsi, session *now, const char *type, const unsigned char *body,
                       size_t size) {
    unsigned char buffer[LWS_PRE + HEAD_MAX], *const start = buffer + LWS_PRE, *at = start,
                                                     *const end = buffer + sizeof buffer;
    char policy[HOST_MAX + 256];
    /* A policy cannot name an IPv6 address; in today's browsers 'self' includes it. */
    const bool named = now->host[0] != '[';
    snprintf(policy, sizeof policy,
             "default-src 'self'; img-src 'self' blob: data:; connect-src 'self'%s%s; "
             "frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
             named ? " ws://" : "", named ? now->host : "");
    if (lws_add_http_common_headers(wsi, HTTP_STATUS_OK, type, size, &at, end) ||
        !add_header(wsi, "content-security-policy:", policy, &at, end) ||
        lws_finalize_write_http_header(wsi, start, &at, end))
        return -1;
    now->body = body;
    now->left = size;
    lws_callback_on_writable(wsi);
    return 0;
}

static int write_body(struct lws *wsi, session *now) {
    unsigned char buffer[LWS_PRE + CHUNK];
    const size_t size = now->left < CHUNK ? now->left : CHUNK;
    memcpy(buffer + LWS_PRE, now->body, size);
    now->body += size;
    now->left -= size;
    if (lws_write(wsi, buffer + LWS_PRE, size, now->left ? LWS_WRITE_HTTP : LWS_WRITE_HTTP_FINAL) <
        (int)size)
        return -1;
    if (now->left) {
        lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, REQUEST_S);
        lws_callback_on_writable(wsi);
        return 0;
    }
    now->body = NULL;
    view_draw_sent(server_of(wsi)->draw, now->drawn);
    now->drawn = NULL;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

/* ---- Sessions ---- */

static void enlist(view_server *s, session *now, struct lws *wsi) {
    view_crowd_leave(&s->crowd, wsi);
    now->wsi = wsi;
    now->next = s->sessions;
    s->sessions = now;
}

static void end_session(view_server *s, session *now) {
    for (session **at = &s->sessions; *at; at = &(*at)->next)
        if (*at == now) {
            *at = now->next;
            break;
        }
    view_talk_close(now->talk);
    view_draw_leave(now->seat);
    view_draw_sent(s->draw, now->drawn);
    *now = (session){0};
}

static bool has_output(const session *now) {
    return now->talk ? view_talk_any(now->talk) : now->seat && view_seat_any(now->seat);
}

static void wake_sessions(view_server *s) {
    for (session *at = s->sessions; at; at = at->next)
        if (has_output(at))
            lws_callback_on_writable(at->wsi);
}

/* Drop clients that have left while waiting for a picture: libwebsockets does not read from them,
 * and so does not notice. Returns whether any client waits. */
static bool drop_gone(view_server *s) {
    bool any = false;
    for (session *at = s->sessions; at; at = at->next) {
        struct pollfd end = {.fd = lws_get_socket_fd(at->wsi), .events = POLLRDHUP};
        if (!at->seat)
            continue;
        any = true;
        if (poll(&end, 1, 0) > 0)
            lws_set_timeout(at->wsi, PENDING_TIMEOUT_HTTP_CONTENT, LWS_TO_KILL_ASYNC);
    }
    return any;
}

/* Look for further steps, and tell pages of those that were found. */
static void follow_files(view_server *s) {
    const double now = clock_seconds();
    bool any = false;
    for (session *at = s->sessions; at; at = at->next) {
        if (!at->talk)
            continue;
        any = true;
        if (view_talk_follow(at->talk))
            lws_callback_on_writable(at->wsi);
    }
    if (!any || now - s->refreshed < REFRESH_S)
        return;
    s->refreshed = now;
    view_draw_refresh(s->draw);
}

/* Wake up regularly, as a signal may come just before the wait for events. Also drop clients, and
 * look for further steps. */
static void tick(lws_sorted_usec_list_t *sul) {
    view_server *s = lws_container_of(sul, view_server, tick);
    const bool waits = drop_gone(s);
    follow_files(s);
    lws_sul_schedule(s->context, 0, &s->tick, tick, waits ? GONE_US : TICK_US);
}

/* ---- HTTP ---- */

static status describe_picture(struct lws *wsi, view_wish *wish) {
    view_server *s = server_of(wsi);
    char size[32], file[16];
    snprintf(size, sizeof size, "%s", argument(wsi, "size="));
    snprintf(file, sizeof file, "%s", argument(wsi, "file="));
    const char *type = argument(wsi, "type=");
    if (type[0] && strcmp(type, "png") != 0 && strcmp(type, "exr") != 0)
        return status_describe(ST_UNSUPPORTED, "pictures are sent as png or exr\n");
    wish->kind = strcmp(type, "exr") == 0 ? VIEW_FILE_EXR : VIEW_FILE_PNG;
    const char *state = argument(wsi, "state=");
    return view_talk_file(s->m, s->options.files, s->options.file_count, s->options.scene, state,
                          size, file, wish);
}

static int answer_picture(struct lws *wsi, session *now) {
    static view_wish wish;
    view_server *s = server_of(wsi);
    if (!has_token(wsi))
        return answer_status(wsi, HTTP_STATUS_FORBIDDEN, "a token is needed\n");
    const status st = describe_picture(wsi, &wish);
    now->seat = st == ST_OK ? view_draw_sit(s->draw) : NULL;
    if (!now->seat)
        view_wish_release(&wish);
    if (st != ST_OK)
        return answer_status(wsi, HTTP_STATUS_BAD_REQUEST, view_message_why());
    if (!now->seat)
        return answer_status(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE, "too many clients\n");
    now->exr = wish.kind == VIEW_FILE_EXR;
    enlist(s, now, wsi);
    lws_set_timeout(wsi, NO_PENDING_TIMEOUT, 0);
    view_seat_want(now->seat, &wish);
    view_wish_release(&wish);
    lws_sul_schedule(s->context, 0, &s->tick, tick, GONE_US);
    return 0;
}

/* Answer with the scene as a page shows it, as a scene file. */
static int answer_scene(struct lws *wsi, session *now) {
    view_server *s = server_of(wsi);
    if (!has_token(wsi))
        return answer_status(wsi, HTTP_STATUS_FORBIDDEN, "a token is needed\n");
    if (!s->options.scene)
        return answer_status(wsi, HTTP_STATUS_NOT_FOUND, "there is no scene\n");
    if (view_saved_scene(s->m, s->options.scene, argument(wsi, "state="), &now->drawn) != ST_OK)
        return answer_status(wsi, HTTP_STATUS_BAD_REQUEST, view_message_why());
    enlist(s, now, wsi);
    return answer_body(wsi, now, "application/json", now->drawn->bytes, now->drawn->size);
}

/* Answer with the reason that the drawing thread gives. */
static int answer_failure(struct lws *wsi, const view_message *said) {
    json_t *object = json_loadb((const char *)said->bytes, said->size, 0, NULL);
    const char *why = json_string_value(json_object_get(object, "why"));
    const int result =
        answer_status(wsi, HTTP_STATUS_BAD_REQUEST, why ? why : "the picture cannot be drawn\n");
    json_decref(object);
    return result;
}

static int send_picture(struct lws *wsi, session *now) {
    now->drawn = view_seat_take(now->seat);
    if (!now->drawn)
        return 0;
    view_draw_leave(now->seat);
    now->seat = NULL;
    if (now->drawn->failed)
        return answer_failure(wsi, now->drawn);
    return answer_body(wsi, now, now->exr ? "image/x-exr" : "image/png", now->drawn->bytes,
                       now->drawn->size);
}

static int answer_request(struct lws *wsi, session *now, const char *path) {
    view_page page;
    if (now->wsi || now->body)
        return -1; /* one request at a time */
    *now = (session){0};
    if (!is_own_page(wsi, now->host))
        return answer_status(wsi, HTTP_STATUS_FORBIDDEN, "not from here\n");
    if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) == 0)
        return answer_status(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, "only GET\n");
    if (strcmp(path, "/picture") == 0)
        return answer_picture(wsi, now);
    if (strcmp(path, "/scene") == 0)
        return answer_scene(wsi, now);
    if (!view_page_find(path, &page))
        return answer_status(wsi, HTTP_STATUS_NOT_FOUND, "there is nothing\n");
    return answer_body(wsi, now, page.type, page.bytes, page.size);
}

static int go_on(struct lws *wsi, session *now) {
    if (now->body)
        return write_body(wsi, now);
    return now->seat ? send_picture(wsi, now) : 0;
}

/* ---- The socket ---- */

/* Returns 0 if the request may become a WebSocket. */
static int confirm_upgrade(struct lws *wsi) {
    char host[HOST_MAX], path[16];
    if (!header(wsi, WSI_TOKEN_GET_URI, path, sizeof path) || strcmp(path, "/socket") != 0)
        return answer_status(wsi, HTTP_STATUS_NOT_FOUND, "there is nothing\n") ? -1 : 1;
    if (!is_own_page(wsi, host) || !has_token(wsi))
        return answer_status(wsi, HTTP_STATUS_FORBIDDEN, "not from here, or without the token\n")
                   ? -1
                   : 1;
    return 0;
}

static int open_socket(struct lws *wsi, session *now) {
    view_server *s = server_of(wsi);
    *now = (session){0};
    now->talk = view_talk_open(s->m, s->draw, s->options.files, s->options.file_count,
                               s->options.scene, &s->options.machine, s->options.life);
    if (!now->talk)
        return -1;
    enlist(s, now, wsi);
    lws_callback_on_writable(wsi);
    return 0;
}

static int close_because(struct lws *wsi, enum lws_close_status why) {
    lws_close_reason(wsi, why, NULL, 0);
    return -1;
}

static int receive(struct lws *wsi, session *now, const void *bytes, size_t size) {
    if (lws_frame_is_binary(wsi))
        return close_because(wsi, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE);
    const bool last = lws_is_final_fragment(wsi) && lws_remaining_packet_payload(wsi) == 0;
    switch (view_talk_receive(now->talk, bytes, size, last)) {
    case VIEW_TALK_TOO_LONG: return close_because(wsi, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE);
    case VIEW_TALK_TOO_FAST: return close_because(wsi, LWS_CLOSE_STATUS_POLICY_VIOLATION);
    case VIEW_TALK_FINE: break;
    }
    if (view_talk_any(now->talk))
        lws_callback_on_writable(wsi);
    return 0;
}

static int send_next(struct lws *wsi, session *now) {
    view_message *message = view_talk_next(now->talk);
    if (!message)
        return 0;
    const int sent = lws_write(wsi, message->bytes, message->size,
                               message->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
    view_message_free(message);
    if (sent < 0)
        return -1;
    if (view_talk_any(now->talk))
        lws_callback_on_writable(wsi);
    return 0;
}

/* ---- libwebsockets ---- */

static void admit(view_server *s, struct lws *wsi) {
    struct lws *oldest = view_crowd_enter(&s->crowd, wsi);
    if (oldest)
        lws_set_timeout(oldest, PENDING_TIMEOUT_AWAITING_PING, LWS_TO_KILL_ASYNC);
}

/* Accept a connection. libwebsockets cannot take over a listening socket, only its connections. */
static void accept_next(view_server *s) {
    const int on = 1, fd = accept4(s->options.listener, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0)
        return; /* the client has left already */
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)lws_adopt_socket_vhost(s->vhost, fd); /* closes it on failure */
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t size) {
    session *now = user;
    switch (reason) {
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED: admit(server_of(wsi), wsi); return 0;
    case LWS_CALLBACK_WSI_DESTROY: view_crowd_leave(&server_of(wsi)->crowd, wsi); return 0;
    case LWS_CALLBACK_RAW_RX_FILE: accept_next(server_of(wsi)); return 0;
    case LWS_CALLBACK_HTTP: return answer_request(wsi, now, in);
    case LWS_CALLBACK_HTTP_WRITEABLE: return go_on(wsi, now);
    case LWS_CALLBACK_HTTP_BODY: return -1;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE: return confirm_upgrade(wsi);
    case LWS_CALLBACK_ESTABLISHED: return open_socket(wsi, now);
    case LWS_CALLBACK_RECEIVE: return now->talk ? receive(wsi, now, in, size) : -1;
    case LWS_CALLBACK_SERVER_WRITEABLE: return now->talk ? send_next(wsi, now) : -1;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED: wake_sessions(server_of(wsi)); return 0;
    case LWS_CALLBACK_CLOSED:
    case LWS_CALLBACK_CLOSED_HTTP:
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
        if (now)
            end_session(server_of(wsi), now);
        return 0;
    default: return 0;
    }
}

static void notify(void *ctx) {
    const view_server *s = ctx;
    lws_cancel_service(s->context);
}

static void keep_quiet(int level, const char *line) {
    (void)level;
    (void)line;
}

static bool is_ipv6(const char *address) {
    return address && strchr(address, ':');
}

static status make_context(view_server *s) {
    static const struct lws_protocols protocols[] = {{.name = "leafcast",
                                                      .callback = on_event,
                                                      .per_session_data_size = sizeof(session),
                                                      .rx_buffer_size = 16 << 10},
                                                     {0}};
    static const lws_retry_bo_t idle = {.secs_since_valid_ping = PING_S,
                                        .secs_since_valid_hangup = HANGUP_S};
    static const struct lws_protocol_vhost_options
        no_referrer = {NULL, NULL, "referrer-policy:", "no-referrer"},
        own_only = {&no_referrer, NULL, "cross-origin-resource-policy:", "same-origin"},
        no_store = {&own_only, NULL, "cache-control:", "no-store"},
        no_sniff = {&no_store, NULL, "x-content-type-options:", "nosniff"};
    const int listener = s->options.listener;
    const struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = protocols,
        .gid = (gid_t)-1,
        .uid = (uid_t)-1,
        .user = s,
        .server_string = "leafcast",
        .headers = &no_sniff,
        .max_http_header_data2 = VIEW_HEADERS_MAX,
        .max_http_header_pool = CONNECTIONS_MAX, /* made on demand; beyond it requests wait */
        .fd_limit_per_thread = CONNECTIONS_MAX,
        .timeout_secs = REQUEST_S,
        .keepalive_timeout = REQUEST_S,
        .pt_serv_buf_size = CHUNK,
        .retry_and_idle_policy = &idle,
        .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                   (is_ipv6(s->options.address)
                        ? LWS_SERVER_OPTION_IPV6_V6ONLY_MODIFY | LWS_SERVER_OPTION_IPV6_V6ONLY_VALUE
                        : LWS_SERVER_OPTION_DISABLE_IPV6)};
    lws_set_log_level(LLL_ERR, keep_quiet);
    s->context = lws_create_context(&info);
    if (!s->context)
        return status_describe(ST_NOMEM, "no memory for a server");
    s->vhost = lws_create_vhost(s->context, &info);
    if (!s->vhost || !lws_adopt_descriptor_vhost(s->vhost, LWS_ADOPT_RAW_FILE_DESC,
                                                 (lws_sock_file_fd_type){.filefd = listener},
                                                 protocols[0].name, NULL))
        return status_describe(ST_NOMEM, "no memory for a server");
    return ST_OK;
}

static bool is_any(const char *address) {
    struct in6_addr bytes = IN6ADDR_ANY_INIT;
    const struct in6_addr any = bytes;
    const bool six = is_ipv6(address);
    return inet_pton(six ? AF_INET6 : AF_INET, address, &bytes) == 1 &&
           memcmp(&bytes, &any, six ? sizeof any : sizeof(struct in_addr)) == 0;
}

/* Set the name in addresses: the own address, or the host's name when listening at all
 * addresses. */
static void name_self(view_server *s) {
    const char *address = s->options.address;
    if (!is_any(address) || gethostname(s->own, sizeof s->own - 1) != 0)
        snprintf(s->own, sizeof s->own, is_ipv6(address) ? "[%s]" : "%s", address);
    snprintf(s->url, sizeof s->url, "http://%s:%d/?token=%s", s->own,
             view_listen_port(s->options.listener), s->options.token);
}

status view_server_open(mem *m, const view_server_options *options, view_server **out) {
    view_server *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->options = *options;
    status st = make_context(s);
    if (st == ST_OK) {
        name_self(s);
        st = view_draw_open(m, options->files, options->file_count, options->machine.threads,
                            options->life->now, notify, s, &s->draw);
    }
    if (st == ST_OK)
        *out = s;
    else
        view_server_close(s);
    return st;
}

void view_server_close(view_server *s) {
    if (!s)
        return;
    /* First end the clients of the drawing thread; it no longer notifies any when it ends. */
    for (session *at = s->sessions; at; at = at->next) {
        view_talk_close(at->talk);
        view_draw_leave(at->seat);
        at->talk = NULL;
        at->seat = NULL;
    }
    view_draw_close(s->draw);
    s->draw = NULL;
    if (s->context)
        lws_context_destroy(s->context);
    mem_free(s->m, s);
}

const char *view_server_url(const view_server *s) {
    return s->url;
}

void view_server_run(view_server *s, bool (*stop)(void *ctx), void *ctx) {
    lws_sul_schedule(s->context, 0, &s->tick, tick, TICK_US);
    while (!stop(ctx) && lws_service(s->context, 0) >= 0) {}
    lws_sul_cancel(&s->tick);
}
